//! Files of measured camera responses.

use terrella::Response;

/// Reads any text. An accepted file has at least one name, and each name occurs in the text.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else {
        return;
    };
    match Response::names(text) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(names) => {
            assert!(!names.is_empty());
            assert!(names.iter().all(|name| text.contains(name.as_str())));
        }
    }
}

/// Good inputs to start from.
#[allow(dead_code, reason = "the fuzzer reads its corpus from files")]
pub fn seeds() -> Vec<Vec<u8>> {
    let curve = |name: &str| format!("{name}\nB=f(I)\nI =\n0 0.25 0.5 1\nB =\n0 0.5, 0.7\t1\n");
    let film = ["filmRed", "film-Green", "film BLUE"].map(curve).concat();
    [curve("gamma"), film].map(String::into_bytes).into()
}
