//! Operators that WGSL does not let stand together without parentheses. naga accepts them, browsers do not.

use terrella::internals::gpu::SHADER_FILES;

const SHIFTS: [&str; 2] = [" << ", " >> "];
const BITS: [&str; 3] = [" & ", " | ", " ^ "];
const OTHERS: [&str; 11] = [
    " + ", " - ", " * ", " / ", " % ", " == ", " != ", " < ", " > ", " <= ", " >= ",
];

#[test]
fn shifts_and_bits_have_their_parentheses() {
    let mut wrong = Vec::new();
    for (name, text) in SHADER_FILES {
        for (n, line) in text.lines().enumerate() {
            if is_mixed(line) {
                wrong.push(format!("shaders/{name}:{}: {}", n + 1, line.trim()));
            }
        }
    }
    super::hold(&wrong);
}

/// Whether a line mixes shifts or operations of bits with other operators at one depth of parentheses.
fn is_mixed(line: &str) -> bool {
    let mut line = line.split("//").next().unwrap_or_default().to_owned();
    // From the innermost parentheses outwards.
    while let Some(end) = line.find([')', ']']) {
        let start = line[..end].rfind(['(', '[']).map_or(0, |at| at + 1);
        if mixes(&line[start..end]) {
            return true;
        }
        line.replace_range(start.saturating_sub(1)..=end, "x");
    }
    mixes(&line)
}

fn mixes(text: &str) -> bool {
    let parts = text.split(&[',', ';', '{', '}', '('][..]);
    let parts = parts.flat_map(|part| part.split(" && "));
    let parts = parts.flat_map(|part| part.split(" || "));
    let mut parts = parts.flat_map(|part| part.split(" = "));
    parts.any(|part| {
        let count = |operators: &[&str]| {
            let counts = operators.iter().map(|one| part.matches(one).count());
            counts.sum::<usize>()
        };
        let bits = BITS.map(|one| count(&[one]));
        let kinds_of_bits = bits.iter().filter(|count| **count > 0).count();
        let (shifts, others) = (count(&SHIFTS), count(&OTHERS));
        // A shift's operands are unary, and operations of bits combine with their own kind alone.
        shifts + kinds_of_bits > 1 || (shifts + kinds_of_bits > 0 && others > 0)
    })
}

#[test]
fn what_browsers_reject_is_found() {
    for line in [
        "let a = x >> 1u & 3u;",
        "let a = f(x >> (y * 2u) & 1u);",
        "let a = x & y | z;",
        "if x & 1u != 0u {",
        "let a = x << 1u + y;",
        "let a = x << 1u << 2u;",
    ] {
        assert!(is_mixed(line), "{line}");
    }
    for line in [
        "let a = (x >> 1u) & 3u;",
        "let a = tiles[x >> 3u][(x >> 1u) & 3u];",
        "if (x & 1u) != 0u && y > 2u {",
        "let a = f(x & 1u, x >> 1u) * 2.0 - 1.0; // a & b + c",
        "let a = x & y & z;",
        "v ^= v >> vec3u(2u);",
    ] {
        assert!(!is_mixed(line), "{line}");
    }
}
