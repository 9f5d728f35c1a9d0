//! Simulations of Basilisk: pictures of their cameras against another way to the same view, films of every step, files, and the real
//! simulator where it is installed.

#[cfg(target_os = "linux")]
mod keys;
mod pictures;
mod real;

#[path = "../common/basilisk.rs"]
mod messages;

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// Longest that anything is waited for; a machine under load is slow, not wrong.
const PATIENCE: Duration = Duration::from_secs(120);

/// The small scene of a simulation.
fn scene(orbit: &str, camera: &str) -> String {
    format!(
        "[time]\nspeed = 10\nframe_rate_hz = 10\nduration_s = 1000\n[orbit]\nsource = \"basilisk\"\n{orbit}\n[camera]\n{camera}\n\
         [earth]\nnormals = false\nnight_lights = false\n[sky]\nstars = false\n[output]\nsize = [64, 36]\nsamples = 1\nwait_s = 5\n"
    )
}

fn free_port() -> u16 {
    let listener = std::net::TcpListener::bind("127.0.0.1:0").expect("binds");
    listener.local_addr().expect("bound").port()
}

/// A simulator that sends requests like Basilisk's module.
struct Simulator(TcpStream);

fn frame(flags: u8, body: &[u8]) -> Vec<u8> {
    let len = (body.len() as u64).to_be_bytes();
    [&[flags | 2], len.as_slice(), body].concat()
}

impl Simulator {
    /// Connects as soon as somebody listens.
    fn connect(address: SocketAddr) -> Self {
        let begun = std::time::Instant::now();
        let stream = loop {
            match TcpStream::connect(address) {
                Ok(stream) => break stream,
                Err(error) => assert!(begun.elapsed() < PATIENCE, "{error}"),
            }
            std::thread::sleep(Duration::from_millis(20));
        };
        stream.set_read_timeout(Some(PATIENCE)).expect("sets");
        let mut simulator = Self(stream);
        let mut greeting = [0; 64];
        (greeting[0], greeting[9], greeting[10], greeting[11]) = (0xff, 0x7f, 3, 1);
        greeting[12..16].copy_from_slice(b"NULL");
        let ready = b"\x05READY\x0bSocket-Type\0\0\0\x03REQ\x08Identity\0\0\0\0";
        simulator.0.write_all(&greeting).expect("writes");
        simulator.0.write_all(&frame(4, ready)).expect("writes");
        simulator.0.read_exact(&mut [0; 64]).expect("a greeting");
        simulator.frame().expect("a command");
        simulator
    }

    fn frame(&mut self) -> Option<(u8, Vec<u8>)> {
        let mut head = [0; 2];
        self.0.read_exact(&mut head).ok()?;
        let mut bytes = [0; 8];
        match head[0] & 2 {
            0 => bytes[7] = head[1],
            _ => {
                bytes[0] = head[1];
                self.0.read_exact(&mut bytes[1..]).ok()?;
            }
        }
        let mut body = vec![0; u64::from_be_bytes(bytes) as usize];
        self.0.read_exact(&mut body).ok()?;
        Some((head[0], body))
    }

    /// The reply after its empty frame; `None` if the connection ends.
    fn ask(&mut self, frames: &[&[u8]]) -> Option<Vec<Vec<u8>>> {
        let mut bytes = frame(1, b"");
        for (index, body) in frames.iter().enumerate() {
            bytes.extend(frame(u8::from(index + 1 < frames.len()), body));
        }
        self.0.write_all(&bytes).ok()?;
        let mut answer = Vec::new();
        loop {
            let (flags, body) = self.frame()?;
            answer.push(body);
            if flags & 1 == 0 {
                answer.remove(0);
                return Some(answer);
            }
        }
    }

    fn update(&mut self, message: &[u8]) -> bool {
        let answer = self.ask(&[b"SIM_UPDATE", b"", b"", message]);
        answer == Some(vec![b"OK".to_vec()])
    }
}
