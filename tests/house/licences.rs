//! Licences allowed by `deny.toml` are listed for users in THIRD-PARTY.md, and its lists are up to date.

/// Packages with terms beyond their licence expression: for `sofars` those of the IAU SOFA software; for `openh264-sys2` the user is responsible
/// for patent licences of H.264.
const EXTRA_TERMS: &[&str] = &["sofars", "openh264-sys2"];

/// Names after `crate = "` in a text of TOML.
fn crates(toml: &str) -> impl Iterator<Item = &str> {
    toml.split("crate = \"")
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
}

/// Packages with terms that the notes do not name, and packages in a list that are no dependencies. `deny`, `lock` and `notes` are
/// the texts of `deny.toml`, `Cargo.lock` and `THIRD-PARTY.md`.
pub fn faults(deny: &str, lock: &str, notes: &str) -> Vec<String> {
    let (licences, _) = deny.split_once("[bans]").unwrap_or((deny, ""));
    let unnoted = crates(licences)
        .chain(EXTRA_TERMS.iter().copied())
        .filter(|name| !notes.contains(&format!("`{name}`")))
        .map(|name| format!("THIRD-PARTY.md does not name `{name}`"));
    let stale = crates(deny)
        .chain(EXTRA_TERMS.iter().copied())
        .filter(|name| !lock.contains(&format!("name = \"{name}\"")))
        .map(|name| format!("`{name}` is no dependency: remove it from the list"));
    unnoted.chain(stale).collect()
}

#[cfg(test)]
mod tests {
    use super::faults;

    const DENY: &str =
        "exceptions = [{ crate = \"a\", allow = [] }]\n[bans]\ndeny = [{ crate = \"b\" }]";
    const LOCK: &str = "name = \"a\"\nname = \"b\"\nname = \"sofars\"\nname = \"openh264-sys2\"";
    const NOTES: &str = "`a` `sofars` `openh264-sys2`";

    #[test]
    fn what_has_terms_is_noted() {
        assert_eq!(faults(DENY, LOCK, NOTES), [""; 0]);
        for name in ["a", "sofars", "openh264-sys2"] {
            let notes = NOTES.replace(&format!("`{name}`"), "");
            assert_eq!(faults(DENY, LOCK, &notes).len(), 1, "{name}");
        }
    }

    #[test]
    fn lists_hold_dependencies_only() {
        for name in ["a", "b", "sofars", "openh264-sys2"] {
            let lock = LOCK.replace(&format!("\"{name}\""), "\"other\"");
            assert_eq!(faults(DENY, &lock, NOTES).len(), 1, "{name}");
        }
    }
}
