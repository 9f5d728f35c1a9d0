//! Text encodings: UTF-8, UTF-16 by its byte order mark, and the declared encoding of XML.

use super::OrbitError;
use std::path::Path;

/// Encoding of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Encoding {
    Utf8,
    Utf16 { is_big_endian: bool },
    Latin1,
    Windows1252,
}

/// Decodes a text.
///
/// # Errors
/// If it has another encoding, or violates the declared one.
pub(super) fn decode(bytes: Vec<u8>, path: &Path) -> Result<String, OrbitError> {
    let not_text = |before: usize| OrbitError::NotText {
        path: path.to_owned(),
        line: 1 + before,
    };
    let encoding = encoding(&bytes).map_err(|encoding| OrbitError::Encoding {
        path: path.to_owned(),
        encoding,
    })?;
    match encoding {
        Encoding::Utf8 => String::from_utf8(bytes).map_err(|error| {
            let good = error.utf8_error().valid_up_to();
            let before = error.as_bytes().iter().take(good);
            not_text(before.filter(|&&byte| byte == b'\n').count())
        }),
        Encoding::Utf16 { is_big_endian } => {
            let (pairs, rest) = bytes.as_chunks::<2>();
            let unit = |pair: &[u8; 2]| match is_big_endian {
                true => u16::from_be_bytes(*pair),
                false => u16::from_le_bytes(*pair),
            };
            let mut text = String::with_capacity(bytes.len() / 2);
            let lines = |text: &str| text.bytes().filter(|&byte| byte == b'\n').count();
            for character in char::decode_utf16(pairs.iter().map(unit)) {
                match character {
                    Ok(character) => text.push(character),
                    Err(_) => return Err(not_text(lines(&text))),
                }
            }
            match rest.is_empty() {
                true => Ok(text),
                false => Err(not_text(lines(&text))),
            }
        }
        Encoding::Latin1 => Ok(bytes.into_iter().map(char::from).collect()),
        Encoding::Windows1252 => {
            let character = |byte: u8| match byte {
                0x80..0xa0 => WINDOWS_1252.get(usize::from(byte) - 0x80).copied(),
                byte => Some(char::from(byte)),
            };
            let text = bytes.into_iter().map(character);
            Ok(text.map(|c| c.unwrap_or('\u{fffd}')).collect())
        }
    }
}

/// The characters 0x80 to 0x9f of Windows-1252; five are not assigned.
const WINDOWS_1252: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}',
    '\u{90}', '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// The encoding, or the name of one that is not read.
fn encoding(bytes: &[u8]) -> Result<Encoding, String> {
    let utf16 = |is_big_endian| Ok(Encoding::Utf16 { is_big_endian });
    match bytes {
        // A mark, or the first characters of XML without one.
        [0xff, 0xfe, ..] | [b'<', 0, b'?', 0, ..] => return utf16(false),
        [0xfe, 0xff, ..] | [0, b'<', 0, b'?', ..] => return utf16(true),
        _ => {}
    }
    let Some(name) = declared(bytes) else {
        return Ok(Encoding::Utf8);
    };
    match name.to_ascii_uppercase().as_str() {
        // Of UTF-16 the declaration could not be read byte by byte: it has been converted, and left as it was.
        "UTF-8" | "UTF8" | "US-ASCII" | "ASCII" | "UTF-16" => Ok(Encoding::Utf8),
        "ISO-8859-1" | "ISO_8859-1" | "ISO8859-1" | "LATIN1" | "L1" => Ok(Encoding::Latin1),
        "WINDOWS-1252" | "CP1252" => Ok(Encoding::Windows1252),
        _ => Err(name),
    }
}

/// The encoding in the XML declaration.
fn declared(bytes: &[u8]) -> Option<String> {
    const LONGEST: usize = 256;
    let start = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let start = String::from_utf8_lossy(start.get(..start.len().min(LONGEST))?);
    let declaration = start.strip_prefix("<?xml")?.split_once("?>")?.0;
    let value = declaration.split_once("encoding")?.1.trim_start();
    let value = value.strip_prefix('=')?.trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    let name = value.get(1..)?.split(quote).next()?;
    Some(name.trim().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8]) -> Result<String, String> {
        let decoded = decode(bytes.to_vec(), Path::new("a.xml"));
        decoded.map_err(|error| error.to_string())
    }

    fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    #[test]
    fn texts_are_read_by_what_they_say_of_themselves() {
        let xml = |name: &str| format!("<?xml version='1.0' encoding = \"{name}\"?>\n<a>");
        for name in ["ISO-8859-1", "iso-8859-1", "windows-1252"] {
            let mut bytes = xml(name).into_bytes();
            bytes.extend(b"\xc9\xfc");
            assert_eq!(read(&bytes), Ok(format!("{}Éü", xml(name))));
        }
        let mut euro = xml("CP1252").into_bytes();
        euro.push(0x80);
        assert_eq!(read(&euro), Ok(format!("{}€", xml("CP1252"))));
        for text in ["\u{feff}[1]", "\u{feff}é😀\n", &xml("UTF-16")] {
            assert_eq!(read(&utf16(text, u16::to_le_bytes)), Ok(text.to_owned()));
            assert_eq!(read(&utf16(text, u16::to_be_bytes)), Ok(text.to_owned()));
            assert_eq!(read(text.as_bytes()), Ok(text.to_owned()));
        }
    }

    #[test]
    fn other_encodings_are_named() {
        let shift_jis = b"<?xml version=\"1.0\" encoding=\"Shift_JIS\"?><a/>";
        let error = read(shift_jis).unwrap_err();
        assert!(
            error.contains("Shift_JIS") && error.contains("save it in UTF-8"),
            "{error}"
        );
        for bytes in [
            &b"a\nb\n\xff\xff"[..],
            b"\xff\xfea\0\n\0b\0\n\0\x00\xd8",
            b"\xff\xfea\0\n\0b\0\n\0c",
        ] {
            let error = read(bytes).unwrap_err();
            assert!(error.starts_with("a.xml:3: not text"), "{error}");
        }
    }
}
