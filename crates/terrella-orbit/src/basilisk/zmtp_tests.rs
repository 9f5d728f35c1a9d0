use super::*;
use std::collections::VecDeque;

/// A peer whose bytes come in pieces; what is written to it is kept.
struct Peer {
    bytes: VecDeque<u8>,
    piece: usize,
    written: Vec<u8>,
}

impl Read for Peer {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let count = self.piece.min(buffer.len()).min(self.bytes.len());
        for slot in buffer.iter_mut().take(count) {
            *slot = self.bytes.pop_front().unwrap_or_default();
        }
        Ok(count)
    }
}

impl Write for Peer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.written.extend(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn greeting(mechanism: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0; 64];
    (bytes[0], bytes[9], bytes[10], bytes[11]) = (0xff, 0x7f, 3, 1);
    bytes[12..12 + mechanism.len()].copy_from_slice(mechanism);
    bytes
}

/// As libzmq greets.
fn hello(kind: &str) -> Vec<u8> {
    let mut ready = b"\x05READY\x0bSocket-Type\0\0\0".to_vec();
    ready.push(kind.len() as u8);
    ready.extend(kind.as_bytes());
    ready.extend(b"\x08Identity\0\0\0\0");
    [greeting(b"NULL"), frame(COMMAND, &ready)].concat()
}

fn met(bytes: Vec<u8>, piece: usize) -> Result<Connection<Peer>, ZmtpError> {
    let peer = Peer {
        bytes: bytes.into(),
        piece,
        written: Vec::new(),
    };
    Connection::greet(peer, "REP", &["REQ"], 1000, &|| false)
}

#[test]
fn messages_come_whole_however_they_are_cut() {
    let long = vec![7; 600];
    for piece in [1, 3, 100, 100_000] {
        let mut bytes = hello("REQ");
        for body in [b"SIM_UPDATE".as_slice(), b"", &long] {
            bytes.extend(frame(MORE, body));
        }
        bytes.extend(frame(0, b"end"));
        bytes.extend(frame(COMMAND, b"\x04PING\0\x05abc"));
        bytes.extend(frame(0, b"second"));
        let mut connection = met(bytes, piece).expect("greeted");
        let first = connection.receive(&|| false).expect("a message");
        assert_eq!(
            first,
            [
                b"SIM_UPDATE".to_vec(),
                vec![],
                long.clone(),
                b"end".to_vec()
            ]
        );
        let second = connection.receive(&|| false).expect("a message");
        assert_eq!(second, [b"second".to_vec()]);
        assert!(connection.stream.written.ends_with(b"\x04\x08\x04PONGabc"));
        assert!(matches!(
            connection.receive(&|| false),
            Err(ZmtpError::Closed)
        ));
    }
}

#[test]
fn strangers_are_turned_away() {
    let foreign = |bytes| matches!(met(bytes, 64), Err(ZmtpError::Foreign { .. }));
    assert!(foreign(
        b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: text/html,application\r\n\r\n".to_vec()
    ));
    assert!(foreign(
        [greeting(b"PLAIN"), hello("REQ")[64..].to_vec()].concat()
    ));
    assert!(foreign(hello("PUB")));
    assert!(foreign(
        [greeting(b"NULL"), frame(0, b"\x05READY")].concat()
    ));
    assert!(matches!(met(vec![0xff; 20], 64), Err(ZmtpError::Closed)));
}

#[test]
fn nothing_is_taken_that_breaks_the_limits() {
    let rejected = |bytes: &[u8]| {
        let mut connection = met([hello("REQ"), bytes.to_vec()].concat(), 4096).expect("greeted");
        matches!(connection.receive(&|| false), Err(ZmtpError::Limit { .. }))
    };
    // 2⁶³ bytes are announced, and none arrive.
    assert!(rejected(&[LONG, 0x80, 0, 0, 0, 0, 0, 0, 0]));
    assert!(rejected(&frame(0, &[0; 1001])));
    // Their sum exceeds the limit.
    assert!(rejected(
        &[frame(MORE, &[0; 600]), frame(0, &[0; 600])].concat()
    ));
    assert!(rejected(&frame(MORE, b"").repeat(MAX_FRAMES)));
    assert!(rejected(&[COMMAND | LONG, 0, 0, 0, 0, 0, 1, 0, 0]));
    assert!(rejected(&[0x40, 0]));
    assert!(!rejected(&frame(0, &[0; 1000])));
}
