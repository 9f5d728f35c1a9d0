//! The grid mapping of a variable: the ellipsoid of its latitudes and longitudes (CF Conventions 1.11, 5.6 and appendix F).

use super::variable::{Variable, number, text};
use crate::elevation::read::HeightFileError;
use crate::elevation::read::error::FileContext;
use terrella_frames::Ellipsoid;

/// Tolerance of the equatorial radius. GRS80 and WGS72 are within it; the ellipsoids of Clarke and Bessel are not.
const SAME_RADIUS_M: f64 = 3.0;

/// A prime meridian this close to Greenwich counts as Greenwich, degrees: a tenth of a metre.
const GREENWICH_DEG: f64 = 1e-6;

/// Rejects a variable whose mapping is not latitude and longitude of WGS84 or of a system within metres of it.
pub(super) fn check(
    variables: &[Variable],
    chosen: &Variable,
    context: &FileContext,
) -> Result<(), HeightFileError> {
    let Some(mapping) = mapping(variables, chosen) else {
        return Ok(());
    };
    let attributes = &mapping.attributes;
    let other = |crs: String| Err(context.other_coordinates(crs));
    match text(attributes, "grid_mapping_name") {
        None | Some("latitude_longitude") => {}
        Some(name) => return other(format!("coordinates of the grid mapping {name:?}")),
    }
    let radius = ["semi_major_axis", "earth_radius"];
    let radius_m = radius.iter().find_map(|name| number(attributes, name));
    let wgs84_m = Ellipsoid::WGS84.equatorial_radius_m;
    let is_same = |radius_m: &f64| (radius_m - wgs84_m).abs() <= SAME_RADIUS_M;
    if let Some(radius_m) = radius_m.filter(|radius_m| !is_same(radius_m)) {
        return other(format!(
            "latitudes and longitudes of a figure with an equatorial radius of {radius_m} m"
        ));
    }
    let is_greenwich = |degrees: &f64| degrees.abs() < GREENWICH_DEG;
    match number(attributes, "longitude_of_prime_meridian") {
        Some(degrees) if !is_greenwich(&degrees) => other(format!(
            "longitudes from a meridian at {degrees}° of Greenwich's"
        )),
        _ => Ok(()),
    }
}

/// The variable named by `grid_mapping`, in the variable's group or a group above it.
fn mapping<'v>(variables: &'v [Variable], of: &Variable) -> Option<&'v Variable> {
    let named = text(&of.attributes, "grid_mapping")?;
    // In the longer form the coordinates follow: `crs: lat lon`.
    let name = named.split_whitespace().next()?.trim_end_matches(':');
    let mut path = of.name.as_str();
    loop {
        let above = path.rsplit_once('/').map(|(group, _)| group);
        let full = above.map_or_else(|| name.to_owned(), |group| format!("{group}/{name}"));
        let found = variables.iter().find(|variable| variable.name == full);
        if found.is_some() {
            return found;
        }
        path = above?;
    }
}
