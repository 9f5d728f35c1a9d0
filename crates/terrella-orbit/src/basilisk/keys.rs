//! Keys that a script listens to (`keyboardLiveInput`), and those pressed since its last request.

/// Limit of keys that wait for a script's request; further ones are not sent.
const MAX_WAITING: usize = 64;

/// The keys of one simulation.
#[derive(Debug, Default)]
pub struct ScriptKeys {
    heard: String,
    pressed: String,
}

impl ScriptKeys {
    /// From now on these characters are listened to, and no others.
    pub fn listen(&mut self, keys: &str) {
        self.heard = keys.chars().filter(|key| !key.is_whitespace()).collect();
    }

    /// The characters that are listened to.
    pub fn heard(&self) -> &str {
        &self.heard
    }

    /// Records a pressed key. Returns it as the script spells it, if the script listens to it and not too many keys are waiting.
    pub fn press(&mut self, key: char) -> Option<char> {
        let is_same = |heard: &char| heard.to_lowercase().eq(key.to_lowercase());
        let mut heard = self.heard.chars();
        // As it was pressed, else in the other case.
        let exact = self.heard.chars().find(|heard| *heard == key);
        let key = exact.or_else(|| heard.find(is_same))?;
        if self.pressed.chars().count() >= MAX_WAITING {
            return None;
        }
        self.pressed.push(key);
        Some(key)
    }

    /// Returns and clears the keys pressed since the last call.
    pub fn take(&mut self) -> String {
        std::mem::take(&mut self.pressed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_sent_once_and_only_those_that_are_heard() {
        let mut keys = ScriptKeys::default();
        assert_eq!(keys.press('b'), None);
        keys.listen("bX p");
        let presses = ['b', 'B', 'x', 'p', 'q', ' '].map(|key| keys.press(key));
        assert_eq!(
            presses,
            [Some('b'), Some('b'), Some('X'), Some('p'), None, None]
        );
        assert_eq!(
            (keys.take(), keys.take()),
            ("bbXp".to_owned(), String::new())
        );
        for _ in 0..10 * MAX_WAITING {
            keys.press('b');
        }
        assert_eq!(keys.take().len(), MAX_WAITING);
    }
}
