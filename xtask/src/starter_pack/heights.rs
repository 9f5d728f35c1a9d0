//! Sidecars of the elevation maps: place, unit and attribution, in the format that `terrella_ground::elevation::read` reads.

/// For `elevation.png`.
pub const GLOBE: &str = r#"# Heights of the whole Earth, metres + 11 000 (SOURCES.md).
bounds = { south_deg = -90, north_deg = 90, west_deg = -180, east_deg = 180 }
registration = "cells"
unit = "metres"
offset = -11000
attribution = "Amante and Eakins 2009: ETOPO1, NOAA; Natural Earth relief on ice"
"#;

/// For `dem/trinidad.png`. Posts 3″ apart, with the northern edge at 38° N: rows 176 to 1200 and columns 425 to 1449 of the source.
pub const TRINIDAD: &str = r#"# Heights of the Sangre de Cristo Mountains west of Trinidad, Colorado, metres (SOURCES.md).
bounds = { south_deg = 37.146666666666667, north_deg = 38, west_deg = -105.64583333333333, east_deg = -104.7925 }
registration = "posts"
unit = "metres"
attribution = "USGS 3 arc-second DEM; UCAR/NCAR"
"#;
