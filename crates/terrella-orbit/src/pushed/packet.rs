//! One message of a simulator, as a JSON line or in binary.

use super::super::{Frame, OrbitState};
use glam::DVec3;
use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;
use terrella_files::{excerpt, printable};
use terrella_frames::{Duration, Epoch, TimeScale, ccsds_time, utc_from_rfc3339};

/// First bytes of a binary packet. No UTF-8 character starts with the first of them.
pub const MAGIC: [u8; 4] = *b"\x89TRL";
/// Version of the binary form.
pub const VERSION: u8 = 1;
/// Longest line or packet, bytes.
pub const MAX_PACKET_BYTES: usize = 4096;
/// Length of a binary packet with a state, bytes.
pub const STATE_BYTES: usize = 84;

pub(crate) const CRC_BYTES: usize = 4;
/// Longest name, characters.
const MAX_NAME_CHARS: usize = 64;
/// From 1900-01-01, where `hifitime` counts TAI from, to 1970-01-01.
const TAI_1970_NS: i128 = 25_567 * 86_400 * 1_000_000_000;
/// Instants of 1900 and 2100 on the packet's count.
const TAI_NS: std::ops::Range<i128> = -TAI_1970_NS..47_482 * 86_400 * 1_000_000_000;

/// Purpose of a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketKind {
    /// Nothing: it only sends a state.
    State,
    /// A picture of this state, and word when it is drawn.
    Frame,
}

/// A state that a simulator sends.
#[derive(Clone, Debug, PartialEq)]
pub struct Packet {
    /// Whether it only carries a state or requests a frame.
    pub kind: PacketKind,
    /// The simulator's count of its packets; a JSON line with a state may go without.
    pub seq: Option<u64>,
    /// The state.
    pub state: OrbitState,
    /// The satellite's name; JSON only.
    pub name: Option<String>,
}

/// Encoding of a packet; a reply uses that of its request.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketFormat {
    /// A line of JSON.
    Json,
    /// 84 bytes in binary.
    Binary,
}

/// Why a packet is dropped.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum PacketFault {
    /// More bytes than a packet may have.
    #[error("longer than {MAX_PACKET_BYTES} bytes; send one state a line")]
    TooLong,
    /// Neither a JSON object nor a binary packet.
    #[error("neither a JSON object in one line nor a binary packet")]
    NotAPacket,
    /// A line that is no JSON object with the keys of a packet.
    #[error("not a packet in JSON: {cause}")]
    Json {
        /// Error message of the parser.
        cause: String,
    },
    /// A value that cannot be.
    #[error("{key} is {text:?}; expected {expected}")]
    Field {
        key: &'static str,
        /// The value, shortened.
        text: String,
        /// The accepted values.
        expected: &'static str,
    },
    /// Another version of the binary form.
    #[error("binary packet of version {found}; expected {VERSION}")]
    Version { found: u8 },
    /// A binary packet of a wrong length.
    #[error("binary packet of {found} bytes; a state has {STATE_BYTES}")]
    Length {
        /// The declared or actual number of bytes.
        found: usize,
    },
    /// Bytes that changed on the way.
    #[error("CRC-32 is {found:08x}; the bytes give {expected:08x}")]
    Checksum {
        found: u32,
        /// The checksum of its bytes.
        expected: u32,
    },
}

#[derive(Deserialize)]
#[serde(expecting = "an object with epoch, frame, position_m and velocity_m_s")]
struct Line<'t> {
    #[serde(borrow, default)]
    message: Option<Cow<'t, str>>,
    #[serde(default)]
    seq: Option<u64>,
    #[serde(borrow)]
    epoch: Cow<'t, str>,
    #[serde(borrow)]
    frame: Cow<'t, str>,
    #[serde(borrow)]
    position_m: [&'t RawValue; 3],
    #[serde(borrow)]
    velocity_m_s: [&'t RawValue; 3],
    #[serde(borrow, default)]
    name: Option<Cow<'t, str>>,
}

fn field(key: &'static str, text: &str, expected: &'static str) -> PacketFault {
    PacketFault::Field {
        key,
        text: excerpt(text),
        expected,
    }
}

impl Packet {
    /// Reads one line of JSON. Numbers are read to the last bit; unknown keys are skipped.
    ///
    /// # Errors
    /// Says what is wrong; nothing of the line is used then.
    pub fn from_json(line: &[u8]) -> Result<Self, PacketFault> {
        if line.len() > MAX_PACKET_BYTES {
            return Err(PacketFault::TooLong);
        }
        let line = std::str::from_utf8(line).map_err(|_| PacketFault::NotAPacket)?;
        let line: Line<'_> = serde_json::from_str(line).map_err(|e| PacketFault::Json {
            cause: printable(&e.to_string()),
        })?;
        let kind = match line.message.as_deref() {
            None | Some("state") => PacketKind::State,
            Some("frame") => PacketKind::Frame,
            Some(other) => return Err(field("message", other, "\"state\" or \"frame\"")),
        };
        if kind == PacketKind::Frame && line.seq.is_none() {
            return Err(field("seq", "", "a number from 0, to answer with"));
        }
        let epoch = utc_from_rfc3339(&line.epoch)
            .map_err(|_| field("epoch", &line.epoch, "UTC like 2018-01-15T12:00:00.000Z"))?;
        let frame = Frame::from_ccsds_name(&line.frame)
            .ok_or_else(|| field("frame", &line.frame, "GCRF, EME2000, TEME, ITRF or PEF"))?;
        let name = line.name.map(Cow::into_owned);
        if let Some(name) = &name
            && (name.chars().nth(MAX_NAME_CHARS).is_some() || name.chars().any(char::is_control))
        {
            return Err(field("name", name, "at most 64 printable characters"));
        }
        let state = OrbitState {
            epoch,
            frame,
            position_m: vector("position_m", line.position_m)?,
            velocity_m_s: vector("velocity_m_s", line.velocity_m_s)?,
        };
        Ok(Self {
            kind,
            seq: line.seq,
            state: plausible(state)?,
            name,
        })
    }

    /// Reads one binary packet, no byte more.
    ///
    /// # Errors
    /// Says what is wrong; nothing of the packet is used then.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PacketFault> {
        let length = PacketFault::Length { found: bytes.len() };
        let bytes: &[u8; STATE_BYTES] = bytes.try_into().map_err(|_| length)?;
        if bytes[..4] != MAGIC {
            return Err(PacketFault::NotAPacket);
        }
        if bytes[4] != VERSION {
            return Err(PacketFault::Version { found: bytes[4] });
        }
        let said = usize::from(u16::from_le_bytes(part(bytes, 6)));
        if said != STATE_BYTES {
            return Err(PacketFault::Length { found: said });
        }
        let found = u32::from_le_bytes(part(bytes, STATE_BYTES - CRC_BYTES));
        let expected = crc32fast::hash(&bytes[..STATE_BYTES - CRC_BYTES]);
        if found != expected {
            return Err(PacketFault::Checksum { found, expected });
        }
        let kind = match bytes[5] {
            1 => PacketKind::State,
            2 => PacketKind::Frame,
            other => {
                return Err(field(
                    "kind",
                    &other.to_string(),
                    "1, a state, or 2, a frame",
                ));
            }
        };
        let ns = i64::from_le_bytes(part(bytes, 16));
        let frame = frame_from_byte(bytes[24])
            .ok_or_else(|| field("frame", &bytes[24].to_string(), "0…4"))?;
        let number = |index: usize| f64::from_le_bytes(part(bytes, 32 + 8 * index));
        let vector = |first| DVec3::new(number(first), number(first + 1), number(first + 2));
        let state = OrbitState {
            epoch: epoch_from_tai_ns(ns).ok_or_else(|| {
                field(
                    "epoch",
                    &ns.to_string(),
                    "nanoseconds of TAI since 1970, 1900…2099",
                )
            })?,
            frame,
            position_m: vector(0),
            velocity_m_s: vector(3),
        };
        Ok(Self {
            kind,
            seq: Some(u64::from_le_bytes(part(bytes, 8))),
            state: plausible(state)?,
            name: None,
        })
    }

    /// The line of JSON, with its line feed.
    pub fn to_json(&self) -> String {
        let mut object = serde_json::Map::new();
        if self.kind == PacketKind::Frame {
            object.insert("message".to_owned(), "frame".into());
        }
        if let Some(seq) = self.seq {
            object.insert("seq".to_owned(), seq.into());
        }
        if let Some(name) = &self.name {
            object.insert("name".to_owned(), name.as_str().into());
        }
        let epoch = ccsds_time(self.state.epoch, TimeScale::Utc) + "Z";
        object.insert("epoch".to_owned(), epoch.into());
        object.insert("frame".to_owned(), self.state.frame.name().into());
        let vector = |v: DVec3| serde_json::Value::from(v.to_array().to_vec());
        object.insert("position_m".to_owned(), vector(self.state.position_m));
        object.insert("velocity_m_s".to_owned(), vector(self.state.velocity_m_s));
        let mut line = serde_json::Value::Object(object).to_string();
        line.push('\n');
        line
    }

    /// The binary packet; a missing number is 0, a name is left out. `None` for an epoch before 1900 or after 2099.
    pub fn to_bytes(&self) -> Option<[u8; STATE_BYTES]> {
        let ns = self.state.epoch.to_tai_duration().total_nanoseconds() - TAI_1970_NS;
        let ns = i64::try_from(ns)
            .ok()
            .filter(|&ns| TAI_NS.contains(&i128::from(ns)))?;
        let mut bytes = [0; STATE_BYTES];
        bytes[..4].copy_from_slice(&MAGIC);
        bytes[4] = VERSION;
        bytes[5] = match self.kind {
            PacketKind::State => 1,
            PacketKind::Frame => 2,
        };
        bytes[6..8].copy_from_slice(&(STATE_BYTES as u16).to_le_bytes());
        bytes[8..16].copy_from_slice(&self.seq.unwrap_or_default().to_le_bytes());
        bytes[16..24].copy_from_slice(&ns.to_le_bytes());
        bytes[24] = byte_from_frame(self.state.frame);
        let vectors = [self.state.position_m, self.state.velocity_m_s];
        let numbers = vectors.iter().flat_map(|v| v.to_array());
        for (place, number) in bytes[32..80].chunks_exact_mut(8).zip(numbers) {
            place.copy_from_slice(&number.to_le_bytes());
        }
        let crc = crc32fast::hash(&bytes[..STATE_BYTES - CRC_BYTES]);
        bytes[STATE_BYTES - CRC_BYTES..].copy_from_slice(&crc.to_le_bytes());
        Some(bytes)
    }
}

/// The `N` bytes from `at`; the caller's array is longer.
fn part<const N: usize>(bytes: &[u8; STATE_BYTES], at: usize) -> [u8; N] {
    std::array::from_fn(|i| bytes[at + i])
}

fn vector(key: &'static str, numbers: [&RawValue; 3]) -> Result<DVec3, PacketFault> {
    let mut vector = [0.0; 3];
    for (value, number) in vector.iter_mut().zip(numbers) {
        *value = (number.get().parse()).map_err(|_| field(key, number.get(), "three numbers"))?;
    }
    Ok(vector.into())
}

/// Rejects what no satellite of the Earth is.
fn plausible(state: OrbitState) -> Result<OrbitState, PacketFault> {
    let show = |v: DVec3| format!("{:?}", v.to_array());
    if !(1.0..1e13).contains(&state.position_m.length()) {
        let expected = "a position 1 m to 1e13 m from the Earth's centre";
        return Err(field("position_m", &show(state.position_m), expected));
    }
    if !(0.0..299_792_458.0).contains(&state.velocity_m_s.length()) {
        let expected = "a velocity below that of light";
        return Err(field("velocity_m_s", &show(state.velocity_m_s), expected));
    }
    Ok(state)
}

fn epoch_from_tai_ns(ns: i64) -> Option<Epoch> {
    let ns = i128::from(ns);
    let since_1900 = Duration::from_total_nanoseconds(ns + TAI_1970_NS);
    TAI_NS
        .contains(&ns)
        .then(|| Epoch::from_tai_duration(since_1900))
}

/// The order of the binary form.
const FRAMES: [Frame; 5] = [
    Frame::Teme,
    Frame::Pef,
    Frame::Itrf,
    Frame::Gcrf,
    Frame::Eme2000,
];

fn frame_from_byte(byte: u8) -> Option<Frame> {
    FRAMES.get(usize::from(byte)).copied()
}

fn byte_from_frame(frame: Frame) -> u8 {
    match frame {
        Frame::Teme => 0,
        Frame::Pef => 1,
        Frame::Itrf => 2,
        Frame::Gcrf => 3,
        Frame::Eme2000 => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_has_the_published_check_value() {
        assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
        assert_eq!(crc32fast::hash(b""), 0);
    }

    fn packet() -> Packet {
        Packet {
            kind: PacketKind::Frame,
            seq: Some(7),
            state: OrbitState {
                epoch: utc_from_rfc3339("2016-12-31T23:59:60.123456789Z").unwrap(),
                frame: Frame::Eme2000,
                position_m: DVec3::new(6_778_136.3, -0.1, 1.0 / 3.0),
                velocity_m_s: DVec3::new(1e-300, 7_668.557, -2.0 / 7.0),
            },
            name: Some("Sonde \"ä\"".to_owned()),
        }
    }

    #[test]
    fn packets_come_back_to_the_last_bit() {
        let sent = packet();
        assert_eq!(
            Packet::from_json(sent.to_json().as_bytes()),
            Ok(sent.clone())
        );
        for frame in Frame::ALL {
            let mut sent = sent.clone();
            sent.name = None;
            sent.state.frame = frame;
            assert_eq!(
                Packet::from_bytes(&sent.to_bytes().unwrap()),
                Ok(sent.clone())
            );
            assert_eq!(Packet::from_json(sent.to_json().as_bytes()), Ok(sent));
        }
    }

    #[test]
    fn the_binary_form_is_the_documented_one() {
        let mut sent = packet();
        // 1970-01-01T00:00:01 TAI; UTC and TAI count as equal before 1972.
        sent.state.epoch = utc_from_rfc3339("1970-01-01T00:00:01Z").unwrap();
        let bytes = sent.to_bytes().unwrap();
        assert_eq!(bytes[..8], [0x89, b'T', b'R', b'L', 1, 2, 84, 0]);
        assert_eq!(bytes[8..16], 7_u64.to_le_bytes());
        assert_eq!(bytes[16..24], 1_000_000_000_i64.to_le_bytes());
        assert_eq!(bytes[24..32], [4, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(bytes[32..40], 6_778_136.3_f64.to_le_bytes());
        assert_eq!(bytes[72..80], (-2.0 / 7.0_f64).to_le_bytes());
    }

    #[test]
    fn every_changed_byte_is_noticed() {
        let good = packet().to_bytes().unwrap();
        for at in 0..STATE_BYTES {
            let mut bad = good;
            bad[at] ^= 0x10;
            assert!(Packet::from_bytes(&bad).is_err(), "byte {at}");
        }
    }

    #[test]
    fn wrong_values_are_named() {
        let line = |from: &str, to: &str| {
            let text = packet().to_json();
            assert!(text.contains(from), "{text}");
            Packet::from_json(text.replace(from, to).as_bytes())
                .unwrap_err()
                .to_string()
        };
        for (from, to, says) in [
            ("6778136.3", "1e999", "position_m is"),
            ("6778136.3", "\"1\"", "three numbers"),
            ("6778136.3", "NaN", "not a packet in JSON"),
            ("7668.557", "4e8", "below that of light"),
            ("EME2000", "MARS", "expected GCRF"),
            ("2016-12-31", "2015-13-31", "expected UTC"),
            ("\"frame\",\"seq\":7", "\"frame\"", "seq is"),
            ("\"frame\",\"seq\"", "\"ring\",\"seq\"", "message is"),
            ("\"seq\":7", "\"seq\":-1", "not a packet in JSON"),
            ("Sonde", "a\\u0007b", "printable"),
            ("position_m", "position", "missing field `position_m`"),
            ("0.1,", "", "not a packet in JSON"),
        ] {
            let said = line(from, to);
            assert!(said.contains(says), "{to}: {said}");
        }
        let long = format!("{{\"x\":\"{}\"}}", "y".repeat(MAX_PACKET_BYTES));
        assert_eq!(
            Packet::from_json(long.as_bytes()),
            Err(PacketFault::TooLong)
        );
        let deep = "[".repeat(MAX_PACKET_BYTES);
        assert!(Packet::from_json(deep.as_bytes()).is_err());
    }
}
