//! Addresses: tile templates, and the allowed hosts.

use super::token::TOKEN_WORD;

/// Longest address, characters.
pub(super) const MAX_URL_CHARS: usize = 2000;

/// Placeholders of a tile's position in a template, as used by WMTS, TMS and XYZ.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileNames<'a> {
    /// Level as the server names it: `{z}`, `{TileMatrix}`.
    pub level: &'a str,
    /// Column from the west: `{x}`, `{TileCol}`.
    pub column: u32,
    /// Row from the north: `{y}`, `{TileRow}`.
    pub row: u32,
    /// Row from the south, as TMS counts: `{-y}`.
    pub row_from_south: u32,
}

/// Puts a time into a template. `{time}` may not be left in.
pub(super) fn with_time(template: &str, time: Option<&str>) -> String {
    let time = time.unwrap_or_default();
    template.replace("{time}", time).replace("{Time}", time)
}

/// The address of a tile.
pub(super) fn of_tile(template: &str, names: TileNames<'_>) -> String {
    let (column, row) = (names.column.to_string(), names.row.to_string());
    let south = names.row_from_south.to_string();
    let words: [(&str, &str); 9] = [
        ("{z}", names.level),
        ("{TileMatrix}", names.level),
        ("{x}", &column),
        ("{column}", &column),
        ("{TileCol}", &column),
        ("{y}", &row),
        ("{row}", &row),
        ("{TileRow}", &row),
        ("{-y}", &south),
    ];
    words
        .iter()
        .fold(template.to_string(), |url, (word, value)| {
            url.replace(word, value)
        })
}

/// The error in a tile template, if any.
pub(super) fn template_complaint(template: &str) -> Option<String> {
    let has = |words: &[&str]| words.iter().any(|word| template.contains(word));
    let filled = of_tile(
        &with_time(template, Some("0")).replace(TOKEN_WORD, "0"),
        TileNames {
            level: "0",
            column: 0,
            row: 0,
            row_from_south: 0,
        },
    );
    if let Some((_, rest)) = filled.split_once('{') {
        let word = rest.split('}').next().unwrap_or_default();
        return Some(format!(
            "{{{word}}} stands for nothing; known are {{z}}, {{x}}, {{y}}, {{-y}}, {{column}}, {{row}}, {{TileMatrix}}, {{TileRow}}, \
             {{TileCol}}, {{time}}, {{Time}} and {{token}}"
        ));
    }
    if !has(&["{x}", "{column}", "{TileCol}"]) || !has(&["{y}", "{-y}", "{row}", "{TileRow}"]) {
        return Some("must have a column ({x}, {column} or {TileCol}) and a row ({y}, {-y}, {row} or {TileRow})".into());
    }
    url_complaint(&filled)
}

/// The error in an address, if any.
pub(super) fn url_complaint(url: &str) -> Option<String> {
    if url.chars().count() > MAX_URL_CHARS {
        return Some(format!("has more than {MAX_URL_CHARS} characters"));
    }
    let is_plain = url
        .chars()
        .all(|c| c.is_ascii_graphic() && !matches!(c, '"' | '<' | '>' | '\\' | '^' | '`' | '|'));
    let is_good = is_plain && host(url).is_some_and(|host| !host.is_empty());
    (!is_good).then(|| {
        "must be an address that begins with https:// or http:// and has no spaces".to_string()
    })
}

/// Scheme, host and port: a redirect must not change them. `None` for an invalid address, or one with a name and password.
pub(super) fn host(url: &str) -> Option<&str> {
    let (scheme, rest) = url.split_once("://")?;
    if !matches!(scheme, "http" | "https") {
        return None;
    }
    let host = rest.split(['/', '?', '#']).next()?;
    (!host.contains('@') && !host.is_empty()).then_some(host)
}

/// Where a redirect leads, from this address.
pub(super) fn joined(from: &str, to: &str) -> Option<String> {
    let joined = if to.contains("://") {
        to.to_string()
    } else {
        let (scheme, _) = from.split_once("://")?;
        let host = host(from)?;
        if let Some(rest) = to.strip_prefix("//") {
            format!("{scheme}://{rest}")
        } else if to.starts_with('/') {
            format!("{scheme}://{host}{to}")
        } else {
            let path = from.split(['?', '#']).next().unwrap_or(from);
            let folder = path.rsplit_once('/').map_or(path, |(folder, _)| folder);
            format!("{folder}/{to}")
        }
    };
    url_complaint(&joined).is_none().then_some(joined)
}

/// Whether a redirect stays where it may go: on the same host, not from https to http, or on a host that was allowed.
pub(super) fn may_follow(from: &str, to: &str, allowed: &[String]) -> bool {
    let loses_tls = from.starts_with("https://") && !to.starts_with("https://");
    let (Some(from), Some(to)) = (host(from), host(to)) else {
        return false;
    };
    !loses_tls
        && (from.eq_ignore_ascii_case(to)
            || allowed.iter().any(|host| host.eq_ignore_ascii_case(to)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn templates_are_filled_in_every_dialect() {
        let names = TileNames {
            level: "6",
            column: 36,
            row: 13,
            row_from_south: 50,
        };
        for (template, url) in [
            (
                "https://a/{Time}/250m/{TileMatrix}/{TileRow}/{TileCol}.jpg",
                "https://a/2012-07-09/250m/6/13/36.jpg",
            ),
            ("https://a/{z}/{x}/{y}.png", "https://a/6/36/13.png"),
            (
                "https://a/{z}/{x}/{-y}.png?t={time}",
                "https://a/6/36/50.png?t=2012-07-09",
            ),
            ("https://a?r={row}&c={column}", "https://a?r=13&c=36"),
        ] {
            assert_eq!(template_complaint(template), None, "{template}");
            assert_eq!(
                of_tile(&with_time(template, Some("2012-07-09")), names),
                url
            );
        }
        for (template, words) in [
            ("https://a/{z}/{x}.png", "a row"),
            ("https://a/{z}/{y}.png", "a column"),
            ("https://a/{s}/{x}/{y}.png", "{s} stands for nothing"),
            ("ftp://a/{x}/{y}", "https://"),
            ("https://a b/{x}/{y}", "no spaces"),
            ("https://me:secret@a/{x}/{y}", "address"),
            ("https:///{x}/{y}", "address"),
        ] {
            let said = template_complaint(template).unwrap_or_default();
            assert!(said.contains(words), "{template}: {said}");
        }
    }

    #[test]
    fn redirects_stay_where_they_may_go() {
        let from = "https://a.b:8443/x/y?z";
        for (to, url) in [
            ("/q", "https://a.b:8443/q"),
            ("q", "https://a.b:8443/x/q"),
            ("//c/q", "https://c/q"),
            ("http://c/q", "http://c/q"),
        ] {
            assert_eq!(joined(from, to).as_deref(), Some(url));
        }
        assert_eq!(joined(from, "file:///etc/passwd"), None);
        let allowed = ["c".to_string()];
        assert!(may_follow(from, "https://A.b:8443/q", &[]));
        assert!(!may_follow(from, "https://a.b/q", &[]));
        assert!(!may_follow(from, "https://c/q", &[]));
        assert!(may_follow(from, "https://c/q", &allowed));
        // The way back from TLS is no way.
        assert!(!may_follow(from, "http://c/q", &allowed));
        assert!(may_follow("http://a/q", "https://a/q", &[]));
    }
}
