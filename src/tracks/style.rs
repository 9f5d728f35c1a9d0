//! Style of a satellite's tracks: spans of curves, footprint, colours and widths.

use super::ink::Ink;
use super::limits::is_width;
use crate::gpu::{PassFormat, TrackKinds};
use terrella_orbit::FieldOfView;

/// Time before and after now that a curve covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrackSpan {
    /// A number of revolutions, from the orbit's energy at its first state; for an open orbit or a period of more than two days, a number of days.
    Revolutions {
        /// Before now, 0 or more.
        before: f64,
        /// After now, 0 or more.
        after: f64,
    },
    /// Seconds of simulated time.
    Seconds {
        /// Before now, 0 or more.
        before_s: f64,
        /// After now, 0 or more.
        after_s: f64,
    },
}

impl TrackSpan {
    /// Default of a trail: the last revolution, which closes the ellipse.
    pub const TRAIL: Self = Self::Revolutions {
        before: 1.0,
        after: 0.0,
    };
    /// Default of a ground track: half a revolution to each side.
    pub const GROUND_TRACK: Self = Self::Revolutions {
        before: 0.5,
        after: 0.5,
    };
}

/// The ground that a sensor sees.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Footprint {
    /// The sensor's field of view; `None` is all visible ground.
    pub field: Option<FieldOfView>,
    /// Whether the ground inside is tinted.
    pub is_filled: bool,
    /// Whether lines from the satellite show the field of view in space.
    pub has_edges: bool,
    /// The swath: the ground that is swept in this time, tinted.
    pub swath: Option<TrackSpan>,
}

/// The elements of one satellite. An element that is off is not sampled and not uploaded, and if it is off for all satellites, its shader is not
/// compiled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrackStyle {
    /// Colour of lines, marks and fills, display values (sRGB).
    pub color: [u8; 3],
    /// Width of lines, pixels.
    pub width_px: f32,
    /// The trail: the orbit's shape.
    pub trail: Option<TrackSpan>,
    /// The ground track, past and future.
    pub ground_track: Option<TrackSpan>,
    /// The ground that its sensor sees.
    pub footprint: Option<Footprint>,
    /// A ring at the current sub-satellite point.
    pub subpoint: bool,
    /// A dot at its position, and a position for its name.
    pub marker: bool,
}

impl TrackStyle {
    /// No elements, in a separate colour for each satellite of a scene, legible on the day and the night side: seven colours, also distinct for the
    /// colour-blind (after Okabe and Ito 2008, lightened), repeated beyond.
    pub fn new(index: usize) -> Self {
        const COLORS: [[u8; 3]; 7] = [
            [255, 196, 46],
            [92, 200, 255],
            [255, 128, 176],
            [64, 224, 160],
            [255, 140, 64],
            [240, 236, 96],
            [178, 160, 255],
        ];
        Self {
            color: COLORS[index % COLORS.len()],
            width_px: 2.0,
            trail: None,
            ground_track: None,
            footprint: None,
            subpoint: false,
            marker: false,
        }
    }

    /// The sensor's field of view; by default all visible ground.
    pub(super) fn field(&self) -> FieldOfView {
        let field = self.footprint.and_then(|footprint| footprint.field);
        field.unwrap_or(FieldOfView::nadir(std::f64::consts::FRAC_PI_2))
    }

    /// The time of the swath, if one is drawn.
    pub(super) fn swath(&self) -> Option<TrackSpan> {
        self.footprint.and_then(|footprint| footprint.swath)
    }

    /// Whether nothing is drawn.
    pub fn is_nothing(&self) -> bool {
        let kinds = self.kinds();
        !(kinds.lines || kinds.marks)
    }

    /// The pipelines that it needs.
    pub(super) fn kinds(&self) -> TrackKinds {
        let footprint = self.footprint;
        TrackKinds {
            lines: self.trail.or(self.ground_track).is_some() || footprint.is_some(),
            ground_lines: false,
            marks: self.marker || self.subpoint,
            fills: footprint.is_some_and(|footprint| footprint.is_filled),
            polygons: self.swath().is_some(),
        }
    }

    /// Its colour in passes of this format.
    pub(super) fn ink(&self, format: &PassFormat) -> Ink {
        Ink::new(format, self.color, self.kinds().lines)
    }

    /// Rejects angles, spans and widths out of range; the error states the requirement.
    pub(super) fn check(&self) -> Result<(), &'static str> {
        let is_sound = |span: TrackSpan| {
            let (before, after) = match span {
                TrackSpan::Revolutions { before, after } => (before, after),
                TrackSpan::Seconds { before_s, after_s } => (before_s, after_s),
            };
            (0.0..=1e9).contains(&before) && (0.0..=1e9).contains(&after)
        };
        if ![self.trail, self.ground_track, self.swath()]
            .into_iter()
            .flatten()
            .all(is_sound)
        {
            return Err("spans must be from 0 to 1e9");
        }
        let field = self.footprint.and_then(|footprint| footprint.field);
        if let Some(fault) = field.and_then(|field| field.fault()) {
            return Err(fault);
        }
        if !is_width(self.width_px) {
            return Err("the width of lines must be above 0 and at most 64 pixels");
        }
        Ok(())
    }
}
