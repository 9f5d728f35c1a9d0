//! Authentication token: read from the environment when it is sent, and never in a message or file.

use super::error::FetchError;
use std::env::{self, VarError};

/// Placeholder of the token in an address.
pub(super) const TOKEN_WORD: &str = "{token}";

/// Longest token, characters.
const MAX_TOKEN_CHARS: usize = 4096;

/// Longest name of an environment variable, characters.
const MAX_NAME_CHARS: usize = 64;

/// A token. It has no `Debug`, so that no log shows it.
pub(super) struct Token {
    value: String,
    /// Encoded for an address.
    encoded: String,
}

/// The error in the name of the variable with a token, if any.
pub(super) fn name_complaint(name: &str) -> Option<&'static str> {
    let is_word = |b: u8| b.is_ascii_alphanumeric() || b == b'_';
    let is_name = (1..=MAX_NAME_CHARS).contains(&name.len()) && name.bytes().all(is_word);
    (!is_name).then_some(
        "must be the name of an environment variable: 1 to 64 letters, digits and underscores",
    )
}

impl Token {
    /// The token in an environment variable.
    ///
    /// # Errors
    /// [`FetchError::Option`] without the variable, or with one that no address and no header can hold.
    pub(super) fn from_environment(name: &str) -> Result<Self, FetchError> {
        let wrong = |cause: &str| FetchError::Option {
            option: "token_env",
            cause: format!("the environment variable {name} {cause}"),
        };
        match env::var(name) {
            Ok(value) => Self::new(value.trim()).ok_or_else(|| {
                wrong("must hold 1 to 4096 printable ASCII characters without blanks")
            }),
            Err(VarError::NotPresent) => {
                Err(wrong("is not set: set it to the token of the server"))
            }
            Err(VarError::NotUnicode(_)) => Err(wrong("is no text")),
        }
    }

    fn new(value: &str) -> Option<Self> {
        let is_good = (1..=MAX_TOKEN_CHARS).contains(&value.len())
            && value.bytes().all(|b| b.is_ascii_graphic());
        is_good.then(|| Self {
            value: value.to_owned(),
            encoded: value.bytes().map(encoded).collect(),
        })
    }

    /// An address with the token in it.
    pub(super) fn filled(&self, url: &str) -> String {
        url.replace(TOKEN_WORD, &self.encoded)
    }

    /// The header `Authorization` for an address that has no place for the token.
    pub(super) fn header(&self, url: &str) -> Option<String> {
        (!url.contains(TOKEN_WORD)).then(|| format!("Bearer {}", self.value))
    }

    /// A text without the token: servers repeat addresses.
    pub(super) fn hidden(&self, text: &str) -> String {
        text.replace(&self.encoded, TOKEN_WORD)
            .replace(&self.value, TOKEN_WORD)
    }
}

/// A character of a query (RFC 3986, 2.1 and 2.3).
fn encoded(byte: u8) -> String {
    if byte.is_ascii_alphanumeric() || b"-._~".contains(&byte) {
        char::from(byte).to_string()
    } else {
        format!("%{byte:02X}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tokens_stand_where_they_belong_and_in_no_message() {
        let token = Token::new("a/b+1").expect("a token");
        let url = "https://a/{z}?key={token}";
        assert_eq!(token.filled(url), "https://a/{z}?key=a%2Fb%2B1");
        assert_eq!(token.header(url), None);
        assert_eq!(
            token.header("https://a/{z}").as_deref(),
            Some("Bearer a/b+1")
        );
        assert_eq!(
            token.hidden("https://b/?key=a%2Fb%2B1&again=a/b+1"),
            "https://b/?key={token}&again={token}"
        );
        for bad in ["", "a b", "a\nb", "ä", &"a".repeat(4097)] {
            assert!(Token::new(bad).is_none(), "{bad}");
        }
        for (name, is_good) in [("MAPS_TOKEN", true), ("", false), ("A=B", false)] {
            assert_eq!(name_complaint(name).is_none(), is_good, "{name}");
        }
    }
}
