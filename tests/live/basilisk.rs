//! Simulations of Basilisk: a stand-in with the same protocol as its module, over the local network.

mod answers;
mod hostile;
mod publisher;
mod ways_out;

#[path = "../common/basilisk.rs"]
pub mod messages;

use super::PATIENCE;
use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream};
use terrella_frames::{Epoch, utc_from_rfc3339};
use terrella_orbit::basilisk::{Endpoint, Meeting, Simulation, SimulationOptions};

pub fn start() -> Epoch {
    utc_from_rfc3339("2018-01-15T12:00:00Z").expect("a date")
}

pub fn options() -> SimulationOptions {
    let endpoint = Endpoint::Tcp(super::loopback());
    SimulationOptions::new(Meeting::Listen(endpoint))
}

pub fn open(options: SimulationOptions) -> (Simulation, SocketAddr) {
    let simulation = Simulation::open(options, start()).expect("opens");
    let Endpoint::Tcp(address) = *simulation.endpoint() else {
        panic!("no address");
    };
    (simulation, address)
}

/// One end of a ZMTP connection, as libzmq greets.
pub struct Peer(pub TcpStream);

pub fn frame(flags: u8, body: &[u8]) -> Vec<u8> {
    let head = match u8::try_from(body.len()) {
        Ok(len) => vec![flags, len],
        Err(_) => [vec![flags | 2], (body.len() as u64).to_be_bytes().to_vec()].concat(),
    };
    [head, body.to_vec()].concat()
}

impl Peer {
    /// Connects, again and again as libzmq does where it is turned away.
    pub fn connect(address: SocketAddr) -> Self {
        let mut met = None;
        super::until("there is room", || {
            let peer = Self::of(TcpStream::connect(address).expect("connects"));
            met = peer.try_greet("REQ");
            met.is_some()
        });
        met.expect("met")
    }

    pub fn of(stream: TcpStream) -> Self {
        stream.set_read_timeout(Some(PATIENCE)).expect("sets");
        Self(stream)
    }

    pub fn greet(self, kind: &str) -> Self {
        self.try_greet(kind).expect("greeted")
    }

    /// `None` where it is turned away.
    fn try_greet(mut self, kind: &str) -> Option<Self> {
        let mut greeting = [0; 64];
        (greeting[0], greeting[9], greeting[10], greeting[11]) = (0xff, 0x7f, 3, 1);
        greeting[12..16].copy_from_slice(b"NULL");
        let mut ready = b"\x05READY\x0bSocket-Type\0\0\0".to_vec();
        ready.push(kind.len() as u8);
        ready.extend(kind.as_bytes());
        ready.extend(b"\x08Identity\0\0\0\0");
        self.0.write_all(&greeting).ok()?;
        self.0.write_all(&frame(4, &ready)).ok()?;
        let mut its = [0; 64];
        self.0.read_exact(&mut its).ok()?;
        assert_eq!((its[0], its[9], its[10]), (0xff, 0x7f, 3));
        assert_eq!(&its[12..17], b"NULL\0");
        let (flags, its) = self.frame()?;
        assert_eq!(flags, 4);
        assert!(its.starts_with(b"\x05READY\x0bSocket-Type"));
        Some(self)
    }

    pub fn frame(&mut self) -> Option<(u8, Vec<u8>)> {
        let mut head = [0; 2];
        self.0.read_exact(&mut head).ok()?;
        let mut len = usize::from(head[1]);
        if head[0] & 2 != 0 {
            let mut bytes = [head[1], 0, 0, 0, 0, 0, 0, 0];
            self.0.read_exact(&mut bytes[1..]).ok()?;
            len = u64::from_be_bytes(bytes) as usize;
        }
        let mut body = vec![0; len];
        self.0.read_exact(&mut body).ok()?;
        Some((head[0], body))
    }

    pub fn send(&mut self, frames: &[&[u8]]) {
        let mut bytes = Vec::new();
        for (index, body) in frames.iter().enumerate() {
            bytes.extend(frame(u8::from(index + 1 < frames.len()), body));
        }
        self.0.write_all(&bytes).expect("writes");
    }

    /// The next message; `None` if the connection ends.
    pub fn receive(&mut self) -> Option<Vec<Vec<u8>>> {
        let mut frames = Vec::new();
        loop {
            let (flags, body) = self.frame()?;
            frames.push(body);
            if flags & 1 == 0 {
                return Some(frames);
            }
        }
    }

    /// Sends a request like a REQ socket, and receives the reply after its empty frame.
    pub fn ask(&mut self, frames: &[&[u8]]) -> Option<Vec<Vec<u8>>> {
        self.send(&[&[b"".as_slice()], frames].concat());
        let mut answer = self.receive()?;
        assert_eq!(answer.remove(0), b"", "no delimiter");
        Some(answer)
    }

    pub fn update(&mut self, message: &[u8]) {
        let answer = self.ask(&[b"SIM_UPDATE", b"", b"", message]);
        assert_eq!(answer, Some(vec![b"OK".to_vec()]));
    }

    /// The file of an image; empty if there is none.
    pub fn picture(&mut self, id: u64) -> Vec<u8> {
        let answer = self.ask(&[format!("REQUEST_IMAGE_{id}").as_bytes()]);
        let [length, file] = <[Vec<u8>; 2]>::try_from(answer.expect("an answer")).expect("two");
        let length = <[u8; 4]>::try_from(length.as_slice()).expect("four bytes");
        assert_eq!(i32::from_be_bytes(length) as usize, file.len());
        file
    }
}
