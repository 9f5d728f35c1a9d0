//! Earth-fixed elements that the host sets: lines, polygons, stations, marked places, twilight.

use super::ink::Ink;
use super::lines::{LineStyle, MAX_LINE_POINTS, Polylines};
use super::moon_shadow::InkedShadow;
use super::places::{GroundMark, InkedPlace, MAX_PLACES};
use super::polygons::{InkedPolygons, MAX_TRIANGLES, Polygons};
use super::projection::EyeProjection;
use super::stations::{InkedStation, MAX_STATIONS, Station};
use super::twilight::InkedTwilight;
use super::{Tracks, TracksError};
use crate::gpu::{LinePoint, PassFormat, TrackKinds};

/// Polylines, and their colour as the target stores it.
#[derive(Clone)]
pub(super) struct InkedLines {
    pub lines: Polylines,
    pub colors: [[u16; 4]; 2],
}

impl InkedLines {
    pub fn new(lines: Polylines, format: &PassFormat) -> Self {
        let style = lines.style();
        let is_faded = style.opacity < 1.0;
        let colors = Ink::new(format, style.color, is_faded).at(style.opacity);
        Self { lines, colors }
    }
}

/// Adds the points of a frame, those on the ground first: their air is computed at their points. Returns how many these are.
pub(super) fn write_lines(
    all: &[InkedLines],
    eye: &EyeProjection<'_>,
    points: &mut Vec<LinePoint>,
) -> usize {
    let before = points.len();
    let mut write = |are_on_ground: bool| {
        for InkedLines { lines, colors } in all {
            if lines.lies_on_ground() == are_on_ground {
                lines.write(*colors, eye, points);
            }
        }
        points.len() - before
    };
    let on_ground = write(true);
    write(false);
    on_ground
}

impl Tracks {
    /// Replaces the polylines from the next [`Self::prepare`] on; they are drawn beneath all satellites. Makes the pipeline of lines if no style
    /// needed it.
    ///
    /// # Errors
    /// More than [`MAX_LINE_POINTS`] in total. Nothing is changed then.
    pub fn set_lines(&mut self, lines: Vec<Polylines>) -> Result<(), TracksError> {
        if lines.iter().map(Polylines::point_count).sum::<usize>() > MAX_LINE_POINTS {
            let what = "they have more than 1 000 000 points; leave some out";
            return Err(TracksError::Lines { what });
        }
        let kinds = TrackKinds {
            lines: self.kinds.lines || !lines.is_empty(),
            ground_lines: self.kinds.ground_lines || lines.iter().any(Polylines::lies_on_ground),
            ..self.kinds
        };
        self.make_pipelines(kinds)?;
        let format = self.options.format();
        let inked = lines.into_iter();
        self.lines = inked.map(|lines| InkedLines::new(lines, &format)).collect();
        Ok(())
    }

    /// Replaces the polygons from the next [`Self::prepare`] on; they are drawn beneath everything else. Makes the pipeline of polygons if there
    /// was none.
    ///
    /// # Errors
    /// More than [`MAX_TRIANGLES`] in total. Nothing is changed then.
    pub fn set_polygons(&mut self, polygons: Vec<Polygons>) -> Result<(), TracksError> {
        let triangles = polygons.iter().map(Polygons::triangle_count);
        if triangles.sum::<usize>() > MAX_TRIANGLES {
            let what = "polygons have more than 300 000 triangles; leave some out";
            return Err(TracksError::Lines { what });
        }
        let kinds = TrackKinds {
            polygons: self.kinds.polygons || !polygons.is_empty(),
            ..self.kinds
        };
        self.make_pipelines(kinds)?;
        let format = self.options.format();
        let inked = polygons.into_iter();
        self.polygons = inked
            .map(|polygons| InkedPolygons::new(polygons, &format))
            .collect();
        Ok(())
    }

    /// Replaces the stations from the next [`Self::prepare`] on. Each has a mark, the visibility circle of satellite number `followed` at its
    /// current altitude, and a line to every satellite in view, also to those without tracks.
    ///
    /// # Errors
    /// An invalid station, or more than [`MAX_STATIONS`]. Nothing is changed then.
    pub fn set_stations(
        &mut self,
        stations: &[Station],
        followed: usize,
    ) -> Result<(), TracksError> {
        if stations.len() > MAX_STATIONS {
            let what = "there are more than 1000 stations; leave some out";
            return Err(TracksError::Lines { what });
        }
        stations.iter().try_for_each(Station::check)?;
        let kinds = TrackKinds {
            lines: self.kinds.lines || !stations.is_empty(),
            marks: self.kinds.marks || !stations.is_empty(),
            ..self.kinds
        };
        self.make_pipelines(kinds)?;
        let format = self.options.format();
        let stations = stations.iter();
        self.stations = stations
            .map(|station| InkedStation::new(*station, &format))
            .collect();
        self.followed = followed;
        Ok(())
    }

    /// Replaces the marked places from the next [`Self::prepare`] on.
    ///
    /// # Errors
    /// An invalid place, or more than [`MAX_PLACES`]. Nothing is changed then.
    pub fn set_places(&mut self, places: &[GroundMark]) -> Result<(), TracksError> {
        if places.len() > MAX_PLACES {
            let what = "there are more than 20 000 marked places; leave some out";
            return Err(TracksError::Lines { what });
        }
        places.iter().try_for_each(GroundMark::check)?;
        let kinds = TrackKinds {
            marks: self.kinds.marks || places.iter().any(|place| place.is_marked),
            ..self.kinds
        };
        self.make_pipelines(kinds)?;
        let (format, ellipsoid) = (self.options.format(), self.options.ellipsoid);
        let places = places.iter();
        self.places = places
            .map(|place| InkedPlace::new(*place, &ellipsoid, &format))
            .collect();
        Ok(())
    }

    /// Shows or hides the terminator and the ends of twilight ([`TWILIGHT_DEG`](super::TWILIGHT_DEG)) from the next [`Self::prepare`] on, for the
    /// direction to the Sun of [`Self::set_sun`].
    ///
    /// # Errors
    /// A style out of range. Nothing is changed then.
    pub fn set_twilight(&mut self, style: Option<LineStyle>) -> Result<(), TracksError> {
        style.iter().try_for_each(LineStyle::check)?;
        let kinds = TrackKinds {
            lines: self.kinds.lines || style.is_some(),
            ..self.kinds
        };
        self.make_pipelines(kinds)?;
        let format = self.options.format();
        self.twilight = style.map(|style| InkedTwilight::new(style, &format));
        Ok(())
    }

    /// Shows or hides the outlines of the Moon's umbra and penumbra on the ground ([`shadow_outline`](super::shadow_outline)) from the next
    /// [`Self::prepare`] on, for the shadow of [`Self::set_moon_shadow`].
    ///
    /// # Errors
    /// A style out of range. Nothing is changed then.
    pub fn set_shadow_lines(&mut self, style: Option<LineStyle>) -> Result<(), TracksError> {
        style.iter().try_for_each(LineStyle::check)?;
        let kinds = TrackKinds {
            lines: self.kinds.lines || style.is_some(),
            ..self.kinds
        };
        self.make_pipelines(kinds)?;
        let format = self.options.format();
        self.shadow_lines = style.map(|style| InkedShadow::new(style, &format));
        Ok(())
    }
}
