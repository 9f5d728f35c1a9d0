//! The sources that come with the program, and descriptions given by path.

use super::description;
use super::error::FetchError;
use super::source::MapSource;
use std::path::Path;

/// Descriptions, each by its name.
const NAMED: &[(&str, &str)] = &[
    ("black_marble", include_str!("sources/black_marble.toml")),
    ("blue_marble", include_str!("sources/blue_marble.toml")),
    (
        "blue_marble_bathymetry",
        include_str!("sources/blue_marble_bathymetry.toml"),
    ),
    ("modis_aqua", include_str!("sources/modis_aqua.toml")),
    ("modis_terra", include_str!("sources/modis_terra.toml")),
    ("terrarium", include_str!("sources/terrarium.toml")),
    ("viirs_noaa20", include_str!("sources/viirs_noaa20.toml")),
    ("viirs_snpp", include_str!("sources/viirs_snpp.toml")),
];

/// Names of all built-in sources.
pub fn source_names() -> impl Iterator<Item = &'static str> {
    NAMED.iter().map(|(name, _)| *name)
}

pub(super) fn named(name: &str) -> Option<MapSource> {
    let (_, text) = NAMED.iter().find(|(known, _)| *known == name)?;
    // A test reads them all.
    MapSource::from_toml(text, Path::new(name)).ok()
}

/// The source with this name, or the description at a path that ends in `.toml`.
///
/// # Errors
/// [`FetchError`] with the file and the error in it, or the known names.
pub fn find_source(name: &str) -> Result<MapSource, FetchError> {
    if let Some(source) = named(name) {
        return Ok(source);
    }
    let path = Path::new(name);
    if path.extension().is_none_or(|ending| ending != "toml") {
        let near = source_names()
            .map(|known| (strsim::damerau_levenshtein(known, name), known))
            .min()
            .filter(|(distance, _)| *distance <= 4);
        return Err(FetchError::Unknown {
            name: name.to_string(),
            near: near.map(|(_, known)| known.to_string()),
            known: source_names().collect::<Vec<_>>().join(", "),
        });
    }
    MapSource::from_toml(&description::read(path)?, path)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_source_is_good_and_says_whose_it_is() {
        for (name, text) in NAMED {
            let source = MapSource::from_toml(text, Path::new(name)).expect("a good description");
            assert_eq!(source.name, *name);
            assert!(source.citation.contains("https://"), "{name}");
            assert!(
                !source.licence.is_empty() && !source.attribution.is_empty(),
                "{name}"
            );
            let url = source.tiles.expect("tiles").url;
            assert!(url.starts_with("https://"), "{url}");
        }
    }

    #[test]
    fn unknown_names_are_answered_with_a_known_one() {
        let error = find_source("blue_marbel").expect_err("unknown").to_string();
        assert!(error.contains("did you mean blue_marble?"), "{error}");
        let error = find_source("x").expect_err("unknown").to_string();
        assert!(
            !error.contains("did you mean") && error.contains("terrarium"),
            "{error}"
        );
        let error = find_source("gone.toml").expect_err("not there").to_string();
        assert!(error.starts_with("gone.toml: "), "{error}");
    }

    #[test]
    fn times_are_those_of_the_source() {
        let blue = named("blue_marble").expect("there");
        assert_eq!(
            blue.time(Some("2004-12")).expect("good").as_deref(),
            Some("2004-12-01")
        );
        assert_eq!(
            blue.time(None).expect("good").as_deref(),
            Some("2004-08-01")
        );
        for bad in ["2005-01", "2004-13", "2004-08-02", "august", "../../x"] {
            assert!(blue.time(Some(bad)).is_err(), "{bad}");
        }
        let viirs = named("viirs_snpp").expect("there");
        assert!(
            viirs
                .time(None)
                .is_err_and(|error| error.to_string().contains("@2024-06-21"))
        );
        assert!(viirs.time(Some("2024-02-29")).is_ok() && viirs.time(Some("2023-02-29")).is_err());
        assert!(viirs.time(Some("1999-01-01")).is_err());
        let terrarium = named("terrarium").expect("there");
        assert!(terrarium.time(Some("2020-01-01")).is_err());
    }
}
