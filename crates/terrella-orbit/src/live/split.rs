//! Splits a byte stream into packets, skipping anything between them.

use super::super::pushed::{
    MAGIC, MAX_PACKET_BYTES, Packet, PacketFault, PacketFormat, STATE_BYTES,
};

/// Cuts a stream into packets. It holds at most one unfinished packet and the bytes of the last [`Splitter::push`].
///
/// Behind something wrong it goes on at the next line, opening brace or magic, so that one bad byte costs one packet, at most
/// the rest of its line.
#[derive(Debug, Default)]
pub struct Splitter {
    bytes: Vec<u8>,
    /// How many of them are done with.
    done: usize,
    /// In the middle of something wrong, which is counted already.
    is_lost: bool,
}

/// A part of a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Received {
    /// The packet, or why it is invalid.
    pub packet: Result<Packet, PacketFault>,
    /// The format that it came in.
    pub format: PacketFormat,
}

impl Splitter {
    /// Adds bytes. Call [`Splitter::next`] until it returns nothing more.
    pub fn push(&mut self, bytes: &[u8]) {
        self.bytes.drain(..self.done);
        self.done = 0;
        self.bytes.extend_from_slice(bytes);
    }

    /// The next packet; `None` where more bytes are needed.
    #[allow(clippy::should_implement_trait, reason = "it goes on after None")]
    pub fn next(&mut self) -> Option<Received> {
        self.cut(false)
    }

    /// The next packet at the end of the stream: a line may end without a line feed.
    pub fn finish(&mut self) -> Option<Received> {
        self.cut(true)
    }

    /// Bytes that wait for more.
    pub fn waiting(&self) -> usize {
        self.bytes.len() - self.done
    }

    /// Whether anything except blanks is left.
    pub(super) fn has_more(&mut self) -> bool {
        let rest = self.bytes.get(self.done..).unwrap_or_default();
        let blanks = rest.len() - rest.trim_ascii_start().len();
        self.is_lost &= !rest.get(..blanks).is_some_and(|b| b.contains(&b'\n'));
        self.done += blanks;
        self.waiting() > 0
    }

    fn cut(&mut self, is_end: bool) -> Option<Received> {
        loop {
            let rest = self.bytes.get(self.done..).unwrap_or_default();
            let &first = rest.first()?;
            if first.is_ascii_whitespace() {
                self.done += 1;
                // A new line is a new packet, good or bad.
                self.is_lost &= first != b'\n';
                continue;
            }
            if first == b'{' {
                return self.line(is_end);
            }
            if first == MAGIC[0] && rest.len() < STATE_BYTES && !is_end {
                // Only what can still become a packet is waited for.
                let length = rest.len().min(MAGIC.len());
                if rest[..length] == MAGIC[..length] && head_is_good(rest) {
                    return None;
                }
            }
            if rest.starts_with(&MAGIC) {
                return Some(self.binary());
            }
            // Something else: skipped to the next place where a packet can begin.
            let next = rest.iter().skip(1).position(|&b| starts(b));
            self.done += next.map_or(rest.len(), |n| n + 1);
            if let Some(received) = self.lose(PacketFault::NotAPacket, PacketFormat::Json) {
                return Some(received);
            }
        }
    }

    /// From `{` to the end of the line, or to a magic, which is in no text.
    fn line(&mut self, is_end: bool) -> Option<Received> {
        let rest = self.bytes.get(self.done..).unwrap_or_default();
        let window = &rest[..rest.len().min(MAX_PACKET_BYTES + 1)];
        let line_feed = window.iter().position(|&b| b == b'\n');
        let window = &window[..line_feed.unwrap_or(window.len())];
        let magic = window.windows(MAGIC.len()).position(|w| w == MAGIC);
        let end = magic.or(line_feed).or_else(|| {
            let is_whole = is_end && rest.len() <= MAX_PACKET_BYTES;
            is_whole.then_some(rest.len())
        });
        let Some(end) = end else {
            if rest.len() <= MAX_PACKET_BYTES {
                return None;
            }
            // No packet can be in so long a line: the rest of it goes as well.
            self.done += MAX_PACKET_BYTES;
            let skipped = self.bytes[self.done..].iter();
            let to = skipped.clone().position(|&b| b == b'\n' || b == MAGIC[0]);
            self.done += to.unwrap_or(skipped.len());
            return match self.lose(PacketFault::TooLong, PacketFormat::Json) {
                Some(received) => Some(received),
                None => self.cut(is_end),
            };
        };
        let packet = Packet::from_json(&rest[..end]);
        self.done += end;
        match packet {
            Ok(packet) => {
                self.is_lost = false;
                Some(Received {
                    packet: Ok(packet),
                    format: PacketFormat::Json,
                })
            }
            Err(fault) => match self.lose(fault, PacketFormat::Json) {
                Some(received) => Some(received),
                None => self.cut(is_end),
            },
        }
    }

    fn binary(&mut self) -> Received {
        let rest = self.bytes.get(self.done..).unwrap_or_default();
        let packet = Packet::from_bytes(&rest[..rest.len().min(STATE_BYTES)]);
        self.is_lost = packet.is_err();
        // A true packet can begin within a false one.
        self.done += match &packet {
            Ok(_) | Err(PacketFault::Field { .. }) => STATE_BYTES,
            Err(_) => MAGIC.len(),
        };
        Received {
            packet,
            format: PacketFormat::Binary,
        }
    }

    /// Merges consecutive errors into one.
    fn lose(&mut self, fault: PacketFault, format: PacketFormat) -> Option<Received> {
        let is_new = !std::mem::replace(&mut self.is_lost, true);
        is_new.then_some(Received {
            packet: Err(fault),
            format,
        })
    }
}

/// Whether a packet or a line can start with this byte.
fn starts(byte: u8) -> bool {
    byte == b'{' || byte == b'\n' || byte == MAGIC[0]
}

/// Whether version and length, as far as available, are those of a state.
fn head_is_good(rest: &[u8]) -> bool {
    let length = (STATE_BYTES as u16).to_le_bytes();
    rest.get(4)
        .is_none_or(|&v| v == super::super::pushed::VERSION)
        && rest.get(6).is_none_or(|&b| b == length[0])
        && rest.get(7).is_none_or(|&b| b == length[1])
}
