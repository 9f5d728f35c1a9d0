//! Metadata of a segment.

use super::super::entry::{Entry, Fields, Keys, RecordError, RecordFault};
use super::super::interpolated::Interpolation;
use crate::Frame;
use glam::DMat3;
use std::path::Path;
use terrella_files::excerpt;
use terrella_frames::{Epoch, TimeScale, epoch_from_tdb, gcrf_from_mod, gcrf_from_tod};

pub const META_KEYS: &Keys = &[
    ("OBJECT_NAME", ""),
    ("OBJECT_ID", ""),
    ("CENTER_NAME", ""),
    ("REF_FRAME", ""),
    ("REF_FRAME_EPOCH", ""),
    ("TIME_SYSTEM", ""),
    ("START_TIME", ""),
    ("USEABLE_START_TIME", ""),
    ("USEABLE_STOP_TIME", ""),
    ("STOP_TIME", ""),
    ("INTERPOLATION", ""),
    ("INTERPOLATION_DEGREE", ""),
];

/// The axes of states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Axes {
    /// Those of a frame.
    Of(Frame),
    /// True equator and equinox of the state's date; states are turned to GCRF when they are read.
    TrueOfDate,
    /// Mean equator and equinox of the state's date; likewise.
    MeanOfDate,
}

impl Axes {
    pub fn from_name(name: &str) -> Option<Self> {
        match name.to_ascii_uppercase().as_str() {
            "TOD" | "TOD_EARTH" | "TRUE_OF_DATE" => Some(Self::TrueOfDate),
            "MOD" | "MOD_EARTH" | "MEAN_OF_DATE" => Some(Self::MeanOfDate),
            _ => Frame::from_ccsds_name(name).map(Self::Of),
        }
    }

    /// The frame that states are in once they have been read.
    pub fn frame(self) -> Frame {
        match self {
            Self::Of(frame) => frame,
            Self::TrueOfDate | Self::MeanOfDate => Frame::Gcrf,
        }
    }

    /// Whether the axes are inertial ones of a date, which another date would change.
    pub fn are_of_date(self) -> bool {
        matches!(
            self,
            Self::Of(Frame::Teme) | Self::TrueOfDate | Self::MeanOfDate
        )
    }

    /// Rotation of a state, if any. The rotation of the axes, 8e-12 rad/s, is neglected in velocities: 6e-5 m/s in low orbit.
    pub fn turn(self, epoch: Epoch) -> Option<DMat3> {
        match self {
            Self::Of(_) => None,
            Self::TrueOfDate => Some(gcrf_from_tod(epoch)),
            Self::MeanOfDate => Some(gcrf_from_mod(epoch)),
        }
    }
}

/// The scale that dates are in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TimeSystem {
    Scale(TimeScale),
    /// Barycentric dynamical time.
    Tdb,
}

impl TimeSystem {
    /// The system that an entry names.
    ///
    /// # Errors
    /// A name that is not known.
    pub fn of(entry: &Entry<'_>, origin: &Path) -> Result<Self, RecordError> {
        Self::from_name(&entry.value).ok_or_else(|| {
            entry.unsupported(
                origin,
                "known time systems are UTC, TAI, TT, TDB and GPS; none is guessed",
            )
        })
    }

    fn from_name(name: &str) -> Option<Self> {
        match name.eq_ignore_ascii_case("TDB") {
            true => Some(Self::Tdb),
            false => TimeScale::from_name(name).map(Self::Scale),
        }
    }

    pub fn epoch(self, entry: &Entry<'_>, origin: &Path) -> Result<Epoch, RecordError> {
        match self {
            Self::Scale(scale) => entry.epoch(origin, scale),
            Self::Tdb => epoch_from_tdb(entry.value.trim()).map_err(|cause| {
                let key = excerpt(&entry.key);
                entry.place.error(origin, RecordFault::Time { key, cause })
            }),
        }
    }
}

/// The axes and the scale of dates that metadata name, of an object about the Earth.
pub fn axes_and_time(meta: &Fields, origin: &Path) -> Result<(Axes, TimeSystem), RecordError> {
    let must = |key| meta.must(key, "", origin);
    let center = must("CENTER_NAME")?;
    if !center.value.eq_ignore_ascii_case("EARTH") {
        return Err(center.unsupported(origin, "only orbits about the Earth are flown"));
    }
    let frame = must("REF_FRAME")?;
    let axes = Axes::from_name(&frame.value).ok_or_else(|| {
        frame.unsupported(
            origin,
            "known frames are ICRF, GCRF, EME2000, TEME, TOD, MOD, ITRF… and GTOD",
        )
    })?;
    // Frames with their own epoch, or none, are used directly.
    if let Some(date) = meta.get("REF_FRAME_EPOCH")
        && axes.are_of_date()
    {
        return Err(date.unsupported(
            origin,
            "axes of a fixed date are not known; only of the state's own",
        ));
    }
    Ok((axes, TimeSystem::of(must("TIME_SYSTEM")?, origin)?))
}

/// Its interpolation, if stated.
pub fn interpolation(meta: &Fields, origin: &Path) -> Result<Option<Interpolation>, RecordError> {
    let Some(method) = meta.get("INTERPOLATION") else {
        return Ok(None);
    };
    let unsupported = || {
        method.unsupported(
            origin,
            "known interpolations are LINEAR, LAGRANGE and HERMITE",
        )
    };
    let linear = Interpolation::from_name(&method.value, 1).ok_or_else(unsupported)?;
    if linear == Interpolation::Linear {
        return Ok(Some(linear));
    }
    let degree = meta.must("INTERPOLATION_DEGREE", "; INTERPOLATION needs it", origin)?;
    let number = degree.value.parse::<usize>().ok();
    let number = number
        .filter(|n| (1..=Interpolation::MAX_DEGREE).contains(n))
        .ok_or_else(|| degree.wrong(origin, "a whole number from 1 to 31"))?;
    Ok(Interpolation::from_name(&method.value, number))
}
