//! Replies to a simulator.

use super::super::pushed::{CRC_BYTES, MAGIC, PacketFormat, VERSION};

/// Magic, version, kind, length, sequence number.
const HEAD_BYTES: usize = 16;
/// Longest explanation in a binary reply, bytes.
const MAX_REASON_BYTES: usize = 512;

/// Reply to a packet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reply {
    /// The picture of this state is drawn.
    Drawn {
        /// The packet's number.
        seq: u64,
    },
    /// There is no picture, or the packet is wrong.
    Error {
        /// The packet's number, where it is known.
        seq: Option<u64>,
        /// The reason, for the simulator.
        reason: String,
    },
}

impl Reply {
    /// As it goes over the wire.
    pub fn to_wire(&self, format: PacketFormat) -> Vec<u8> {
        match format {
            PacketFormat::Json => self.to_json().into_bytes(),
            PacketFormat::Binary => self.to_bytes(),
        }
    }

    fn to_json(&self) -> String {
        let value = match self {
            Self::Drawn { seq } => serde_json::json!({"message": "ack", "seq": seq}),
            Self::Error { seq, reason } => {
                serde_json::json!({"message": "error", "seq": seq, "error": reason})
            }
        };
        format!("{value}\n")
    }

    /// Kind 3 has nothing behind the head, kind 4 a text; a number that is not known is the greatest.
    fn to_bytes(&self) -> Vec<u8> {
        let (kind, seq, text) = match self {
            Self::Drawn { seq } => (3, *seq, ""),
            Self::Error { seq, reason } => (4, seq.unwrap_or(u64::MAX), reason.as_str()),
        };
        let end = text.floor_char_boundary(MAX_REASON_BYTES);
        let text = text.get(..end).unwrap_or_default();
        let length = (HEAD_BYTES + text.len() + CRC_BYTES) as u16;
        let mut bytes = Vec::with_capacity(usize::from(length));
        bytes.extend_from_slice(&MAGIC);
        bytes.extend_from_slice(&[VERSION, kind]);
        bytes.extend_from_slice(&length.to_le_bytes());
        bytes.extend_from_slice(&seq.to_le_bytes());
        bytes.extend_from_slice(text.as_bytes());
        let crc = crc32fast::hash(&bytes);
        bytes.extend_from_slice(&crc.to_le_bytes());
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn replies_are_the_documented_ones() {
        let drawn = Reply::Drawn { seq: 9 };
        assert_eq!(
            drawn.to_wire(PacketFormat::Json),
            b"{\"message\":\"ack\",\"seq\":9}\n"
        );
        let bytes = drawn.to_wire(PacketFormat::Binary);
        assert_eq!(bytes[..8], [0x89, b'T', b'R', b'L', 1, 3, 20, 0]);
        assert_eq!(bytes.len(), 20);
        let reason = "ä".repeat(MAX_REASON_BYTES);
        let error = Reply::Error { seq: None, reason }.to_wire(PacketFormat::Binary);
        assert_eq!(error.len(), HEAD_BYTES + MAX_REASON_BYTES + CRC_BYTES);
        assert_eq!(error[8..16], [0xff; 8]);
    }
}
