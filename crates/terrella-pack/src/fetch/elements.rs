//! Orbital elements of catalogued satellites, fetched from a query server, and cached in a folder until they may be outdated.

use super::address::url_complaint;
use super::description;
use super::error::FetchError;
use super::http::{Client, ClientOptions, GetError};
use super::pace::Pace;
use serde::Deserialize;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};
use terrella_files::{self as files, Unfinished, durable};

/// Descriptions that come with the program, each by its name.
const NAMED: &[(&str, &str)] = &[("celestrak", include_str!("element_sources/celestrak.toml"))];
/// Largest reply, bytes: some ten times all public elements.
const MAX_ANSWER_BYTES: u64 = 64 << 20;
/// Longest name of a group, characters.
const MAX_GROUP_CHARS: usize = 60;
/// Least of `min_age_s` and most of it, seconds: a minute to a week.
const AGE_S: std::ops::RangeInclusive<f64> = 60.0..=604_800.0;
/// The same of `requests_per_s`.
const REQUESTS_PER_S: std::ops::RangeInclusive<f64> = 0.01..=10.0;

/// How a server writes elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub enum ElementMedia {
    /// Two-line elements.
    #[serde(rename = "text/plain")]
    Tle,
    /// OMM in JSON.
    #[serde(rename = "application/json")]
    Json,
}

impl ElementMedia {
    /// As HTTP names it.
    fn name(self) -> &'static str {
        match self {
            Self::Tle => "text/plain",
            Self::Json => "application/json",
        }
    }

    /// Ending of files.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Tle => "tle",
            Self::Json => "json",
        }
    }
}

/// A server of elements, as a TOML file describes it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ElementSource {
    /// Its name.
    pub name: String,
    /// A line about its content.
    pub title: String,
    /// The source of this information.
    pub citation: String,
    /// The address of a satellite's elements: `{number}` is replaced by its catalogue number.
    satellite_url: String,
    /// The address of a group's elements: `{group}` is replaced by its name.
    group_url: Option<String>,
    /// Format of its replies.
    pub media: ElementMedia,
    /// Age below which elements are not requested again, seconds.
    min_age_s: f64,
    /// Most requests a second.
    requests_per_s: f64,
}

/// A query for elements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ElementQuery {
    /// A satellite by its catalogue number.
    Satellite(u32),
    /// The satellites of a group by its name.
    Group(String),
}

/// Elements as the server wrote them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FetchedElements {
    /// The text.
    pub text: String,
    /// The address that they are from.
    pub url: String,
    /// How long ago they came; `None` where they came now.
    pub age: Option<Duration>,
}

/// Why there are no elements.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum ElementsError {
    /// The description, or the options of the client.
    #[error(transparent)]
    Source(#[from] FetchError),
    /// A group for a source without groups, or an invalid group name.
    #[error("--group {group:?}: {cause}")]
    Group { group: String, cause: &'static str },
    /// An error reply of the server.
    #[error("{url}: {cause}; {advice}")]
    Answer {
        url: String,
        cause: String,
        advice: &'static str,
    },
    /// The cache folder.
    #[error("{}: {source}; make room or correct the permissions, or give another --cache", path.display())]
    Cache {
        path: PathBuf,
        source: std::io::Error,
    },
}

impl ElementSource {
    /// The source with this name, or the description at a path that ends in `.toml`.
    ///
    /// # Errors
    /// [`FetchError`] with the file and the error in it, or the known names.
    pub fn find(name: &str) -> Result<Self, FetchError> {
        let path = Path::new(name);
        if let Some((_, text)) = NAMED.iter().find(|(known, _)| *known == name) {
            return Self::from_toml(text, path);
        }
        if path.extension().is_none_or(|ending| ending != "toml") {
            let known: Vec<_> = NAMED.iter().map(|(name, _)| *name).collect();
            return Err(FetchError::Unknown {
                name: name.to_string(),
                near: None,
                known: known.join(", "),
            });
        }
        Self::from_toml(&description::read(path)?, path)
    }

    /// A source from the text of its description; `path` is named in errors.
    ///
    /// # Errors
    /// [`FetchError::Description`] with the line, or the key, that is wrong.
    pub fn from_toml(text: &str, path: &Path) -> Result<Self, FetchError> {
        description::parse(text, path, Self::complaint)
    }

    /// The key that is wrong, and why.
    fn complaint(&self) -> Option<(&'static str, String)> {
        let templates = [
            ("satellite_url", "{number}", Some(&self.satellite_url)),
            ("group_url", "{group}", self.group_url.as_ref()),
        ];
        for (key, word, template) in templates {
            let Some(template) = template else { continue };
            if !template.contains(word) {
                return Some((key, format!("must have {word}")));
            }
            if let Some(cause) = url_complaint(&template.replace(word, "0")) {
                return Some((key, cause));
            }
        }
        if !AGE_S.contains(&self.min_age_s) {
            let cause = format!("must be from {} to {} seconds", AGE_S.start(), AGE_S.end());
            return Some(("min_age_s", cause));
        }
        if !REQUESTS_PER_S.contains(&self.requests_per_s) {
            let (least, most) = (REQUESTS_PER_S.start(), REQUESTS_PER_S.end());
            return Some(("requests_per_s", format!("must be from {least} to {most}")));
        }
        let texts = [&self.name, &self.title, &self.citation];
        texts
            .iter()
            .any(|text| text.is_empty() || text.len() > 1000 || text.contains(char::is_control))
            .then(|| {
                let cause = "must be lines of 1 to 1000 characters without control characters";
                ("name, title, citation", cause.to_string())
            })
    }

    /// Age below which elements are not requested again.
    pub fn min_age(&self) -> Duration {
        Duration::from_secs_f64(self.min_age_s)
    }

    /// The address of a query.
    fn url(&self, query: &ElementQuery) -> Result<String, ElementsError> {
        let wrong = |group: &str, cause| ElementsError::Group {
            group: group.to_string(),
            cause,
        };
        match query {
            ElementQuery::Satellite(number) => {
                Ok(self.satellite_url.replace("{number}", &number.to_string()))
            }
            ElementQuery::Group(group) => {
                let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_.".contains(&byte);
                if !(1..=MAX_GROUP_CHARS).contains(&group.len()) || !group.bytes().all(is_plain) {
                    let cause = "must be 1 to 60 letters, digits, hyphens, underscores and dots";
                    return Err(wrong(group, cause));
                }
                let template = self.group_url.as_ref();
                let template =
                    template.ok_or_else(|| wrong(group, "this source has no group_url"))?;
                Ok(template.replace("{group}", group))
            }
        }
    }

    /// The elements of each query, from the folder `cache` if they are there and recent enough, else from the server, in sequence. A reply is kept
    /// if `check` accepts it; otherwise `check` returns the error.
    ///
    /// # Errors
    /// [`ElementsError`]. Cached files stay.
    pub fn fetch(
        &self,
        queries: &[ElementQuery],
        cache: &Path,
        options: ClientOptions,
        check: &dyn Fn(&ElementQuery, &str) -> Result<(), String>,
    ) -> Result<Vec<FetchedElements>, ElementsError> {
        let client = Client::new(options, None)?;
        let pace = Pace::new(self.requests_per_s);
        let fetch = |query| {
            let url = self.url(query)?;
            let name = blake3::hash(url.as_bytes()).to_hex();
            let path = cache.join(&name[..32]).with_extension(self.media.ending());
            if let Some((text, age)) = young(&path, self.min_age()) {
                return Ok(FetchedElements {
                    text,
                    url,
                    age: Some(age),
                });
            }
            pace.wait(&|| false);
            let text = self.get(&client, &url)?;
            check(query, &text).map_err(|cause| ElementsError::Answer {
                url: url.clone(),
                cause,
                advice: "check the catalogue number, the group and the source's description",
            })?;
            keep(&path, &text).map_err(|source| ElementsError::Cache {
                path: path.clone(),
                source,
            })?;
            Ok(FetchedElements {
                text,
                url,
                age: None,
            })
        };
        queries.iter().map(fetch).collect()
    }

    fn get(&self, client: &Client, url: &str) -> Result<String, ElementsError> {
        let wrong = |cause: String, advice| ElementsError::Answer {
            url: url.to_string(),
            cause,
            advice,
        };
        let mut bytes = Vec::new();
        client
            .get(
                url,
                self.media.name(),
                MAX_ANSWER_BYTES,
                &mut bytes,
                &|| false,
            )
            .map_err(|error| wrong(error.to_string(), advice(&error)))?;
        String::from_utf8(bytes).map_err(|_| {
            let advice = "correct the media in the source's description";
            wrong("the answer is not UTF-8".to_string(), advice)
        })
    }
}

/// The remedy after a failed request.
fn advice(error: &GetError) -> &'static str {
    match error {
        GetError::Status { code, .. } => match code {
            404 | 410 | 204 => "check the catalogue number or the group",
            401 => "the source wants a user; download the file with its own tools",
            403 | 429 => "it does not want to be asked so often; wait two hours",
            _ => "try again later",
        },
        GetError::Redirect { .. } => "correct the address in the source's description",
        GetError::Certificate(_) => {
            "check the address and this machine's clock; an authority of your own is given with --ca"
        }
        GetError::Media { .. } | GetError::Compressed(_) | GetError::TooLarge { .. } => {
            "correct the source's description"
        }
        _ => "check the connection, then try again",
    }
}

/// A cached text and its age, if that is less than `min_age`. A text dated in the future does not count.
fn young(path: &Path, min_age: Duration) -> Option<(String, Duration)> {
    let kept = path.metadata().and_then(|data| data.modified()).ok()?;
    let age = SystemTime::now().duration_since(kept).ok()?;
    if age >= min_age {
        return None;
    }
    let text = files::read_text(path, MAX_ANSWER_BYTES).ok()??;
    Some((text, age))
}

/// Writes a text through a temporary name, so that it is whole or not there.
fn keep(path: &Path, text: &str) -> std::io::Result<()> {
    if let Some(folder) = path.parent() {
        durable::make_folders(folder)?;
    }
    let part = path.with_extension(format!("{}.part", std::process::id()));
    let (mut file, _unfinished) = Unfinished::create(&part, |path| File::create(path))?;
    let written = file
        .write_all(text.as_bytes())
        .and_then(|()| durable::replace(&part, path));
    if written.is_err() {
        // It is ours and incomplete.
        let _ = std::fs::remove_file(&part);
    }
    written
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "name = \"a\"\ntitle = \"b\"\ncitation = \"c\"\nsatellite_url = \"http://a/?n={number}\"\n\
                        media = \"text/plain\"\nmin_age_s = 100\nrequests_per_s = 1\n";

    #[test]
    fn the_shipped_source_asks_as_its_documentation_says() {
        let source = ElementSource::find("celestrak").expect("shipped");
        let url = |query| source.url(&query).expect("an address");
        assert_eq!(
            url(ElementQuery::Satellite(25_544)),
            "https://celestrak.org/NORAD/elements/gp.php?CATNR=25544&FORMAT=TLE"
        );
        assert_eq!(
            url(ElementQuery::Group("gps-ops".into())),
            "https://celestrak.org/NORAD/elements/gp.php?GROUP=gps-ops&FORMAT=TLE"
        );
        assert_eq!(source.min_age(), Duration::from_secs(7200));
        let error = ElementSource::find("spacetrak").expect_err("unknown");
        assert!(error.to_string().contains("celestrak"), "{error}");
    }

    #[test]
    fn descriptions_and_groups_are_checked() {
        let read = |text: &str| ElementSource::from_toml(text, Path::new("s.toml"));
        let source = read(GOOD).expect("a good description");
        for (from, to, said) in [
            ("{number}", "1", "s.toml: satellite_url: must have {number}"),
            ("http:", "ftp:", "satellite_url: must be an address"),
            ("100", "1", "min_age_s: must be from 60"),
            (
                "requests_per_s = 1",
                "requests_per_s = 100",
                "requests_per_s: must be",
            ),
            ("media", "medium", "line 5"),
        ] {
            let error = read(&GOOD.replacen(from, to, 1)).expect_err(to).to_string();
            assert!(error.contains(said), "{error}");
        }
        for (group, said) in [
            ("", "must be 1 to 60"),
            ("a&b", "must be 1 to 60"),
            ("stations", "no group_url"),
        ] {
            let error = source.url(&ElementQuery::Group(group.into()));
            let error = error.expect_err("no such group").to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
