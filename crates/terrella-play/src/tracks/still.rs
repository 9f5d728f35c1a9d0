//! Earth-fixed elements of a scene: lines, polygons, marked places and names.

use super::labels::{CityName, NamePlace};
use crate::coverage_layer::coverage_polygons;
use crate::error::PlayError;
use crate::flight::Flight;
use crate::geo_layers::geo_layers;
use crate::map_lines::{dropped_lines, lines, shadow_lines, twilight};
use crate::maps::DroppedLayer;
use crate::place_names::place_names;
use crate::scene::Scene;
use terrella::tracks::{
    GroundMark, LineStyle, NamedPlace, PlaceLabel, Polygons, Polylines, Tracks, TracksError,
};

/// Colour of cities and their names, display values.
const CITY_COLOR: [u8; 3] = [255, 255, 255];

/// All of it, as [`Tracks`] draws it.
#[derive(Default)]
pub(super) struct Still {
    lines: Vec<Polylines>,
    polygons: Vec<Polygons>,
    twilight: Option<LineStyle>,
    shadow_lines: Option<LineStyle>,
    marks: Vec<GroundMark>,
    /// Name of each mark, empty if it has none.
    names: Vec<String>,
    /// The marks after those of files.
    cities: Vec<NamedPlace>,
    /// Most names of cities in a picture.
    pub most_cities: usize,
}

impl Still {
    /// The elements of a scene. Reports the parts of its files that are left out.
    ///
    /// # Errors
    /// A missing or corrupt file, in a strict scene.
    pub fn of(scene: &Scene, flight: &Flight) -> Result<Self, PlayError> {
        let ellipsoid = flight.ellipsoid();
        for DroppedLayer { layer, missing } in dropped_lines(scene)? {
            tracing::warn!("{missing}; {layer} left out");
        }
        let mut lines = lines(scene, ellipsoid)?;
        let taken = lines.iter().map(Polylines::point_count).sum();
        let mut geo = geo_layers(scene, ellipsoid, taken)?;
        for dropped in &geo.dropped {
            tracing::warn!("{}; left out", dropped.missing);
        }
        for note in &geo.notes {
            tracing::warn!("{note}");
        }
        lines.append(&mut geo.lines);
        // Beneath the polygons of files.
        let mut polygons = coverage_polygons(scene, flight)?;
        polygons.append(&mut geo.polygons);
        let (cities, _) = place_names(scene)?;
        let mut marks = geo.marks;
        marks.extend(cities.iter().map(|city| GroundMark {
            place: city.place,
            color: CITY_COLOR,
            opacity: 1.0,
            width_px: 1.0,
            is_marked: false,
            is_named: true,
        }));
        Ok(Self {
            lines,
            polygons,
            twilight: twilight(scene),
            shadow_lines: shadow_lines(scene),
            marks,
            names: geo.names,
            cities,
            most_cities: scene.layers.place_names.unwrap_or(0) as usize,
        })
    }

    /// Draws it from the next picture on.
    pub fn show(&self, tracks: &mut Tracks) -> Result<(), TracksError> {
        tracks.set_lines(self.lines.clone())?;
        tracks.set_polygons(self.polygons.clone())?;
        tracks.set_places(&self.marks)?;
        tracks.set_twilight(self.twilight)?;
        tracks.set_shadow_lines(self.shadow_lines)
    }

    /// Whether there are no elements.
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
            && self.polygons.is_empty()
            && self.marks.is_empty()
            && self.twilight.or(self.shadow_lines).is_none()
    }

    /// The name of a marked place and how it is written where the picture is shown `larger` than it was drawn.
    pub fn name(&self, label: &PlaceLabel, larger: f32) -> Option<(&str, NamePlace)> {
        if let Some(name) = self.names.get(label.place) {
            let place = match self.marks.get(label.place)?.is_marked {
                true => NamePlace::BesideIfRoom,
                false => NamePlace::MiddleIfRoom,
            };
            return Some((name, place));
        }
        let city = self.cities.get(label.place - self.names.len())?;
        let place = NamePlace::City(CityName {
            is_capital: city.is_capital,
            room_px: city.isolation_m as f32 * label.pixels_per_m * larger,
        });
        Some((&city.name, place))
    }
}
