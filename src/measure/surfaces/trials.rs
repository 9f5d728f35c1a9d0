//! Which surfaces are compared, with which settings.

use super::Setting;
use crate::Subdivision;
use crate::globe::{SurfaceKind, SurfaceSettings};

/// A surface to be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// How it is told.
    pub setting: Setting,
    /// What draws.
    pub surface: SurfaceSettings,
    /// Most pixels by which drawn ground may differ, for surfaces that look at it.
    pub tolerance_px: f64,
}

/// Every surface over its settings; `quick` each at its default alone.
pub fn trials(quick: bool) -> Vec<Trial> {
    let mut trials = Vec::new();
    for kind in SurfaceKind::ALL {
        trials.extend(of_kind(*kind));
    }
    trials.retain(|trial| !quick || trial.setting.is_default);
    trials
}

fn of_kind(kind: SurfaceKind) -> Vec<Trial> {
    let trial = |parameter, value: String, is_default, surface, tolerance_px| Trial {
        setting: Setting {
            surface: kind.name(),
            parameter,
            value,
            is_default,
        },
        surface,
        tolerance_px,
    };
    match kind {
        SurfaceKind::Blocks => [12, 24, 48]
            .map(|cells| {
                let surface = kind.settings(Subdivision::Cells(cells));
                trial("cells", cells.to_string(), cells == 48, surface, 1.0)
            })
            .into(),
    }
}
