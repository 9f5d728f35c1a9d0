//! Which surfaces are compared, with which settings.

use super::Setting;
use crate::Subdivision;
use crate::globe::clipmap::ClipmapOptions;
use crate::globe::contours::PageOptions;
use crate::globe::projected_grid::GridOptions;
use crate::globe::{SurfaceKind, SurfaceSettings};
use crate::scene::limits::DEFAULT_TOLERANCE_PX;

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
    let blocks = |cells| {
        let surface = kind.settings(Subdivision::Cells(cells));
        trial("cells", cells.to_string(), cells == 48, surface, 1.0)
    };
    // Of surfaces that look at it, over the tolerance; at the default of scenes they are what a scene gets.
    let tolerances = || {
        [4.0, 2.0, 1.0, 0.5].map(|px| {
            let is_default = px == DEFAULT_TOLERANCE_PX;
            let surface = kind.settings(Subdivision::Auto);
            trial("tolerance px", px.to_string(), is_default, surface, px)
        })
    };
    let grid = |side| {
        let surface = SurfaceSettings::ProjectedGrid(GridOptions {
            samples: (side, side),
            ..GridOptions::default()
        });
        trial("samples", side.to_string(), side == 129, surface, 1.0)
    };
    let clipmap = |samples, levels| {
        let surface = SurfaceSettings::Clipmap(ClipmapOptions {
            samples,
            levels,
            ..ClipmapOptions::default()
        });
        let is_default = surface == kind.settings(Subdivision::Auto);
        let value = format!("{samples} of {levels} levels");
        trial("samples", value, is_default, surface, 1.0)
    };
    match kind {
        SurfaceKind::Blocks => [12, 24, 48].map(blocks).into(),
        SurfaceKind::ProjectedGrid => [65, 129, 257].map(grid).into(),
        SurfaceKind::Quadtree => tolerances().into(),
        SurfaceKind::Contours => {
            let cast = [2.0, 1.0, 0.5].map(|px| {
                let surface = SurfaceSettings::CastContours(PageOptions::default());
                trial("cast, tolerance px", px.to_string(), false, surface, px)
            });
            tolerances().into_iter().chain(cast).collect()
        }
        SurfaceKind::Clipmap => [(65, 12), (129, 6), (129, 12), (257, 12)]
            .map(|(samples, levels)| clipmap(samples, levels))
            .into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_surface_has_one_default() {
        let all = trials(false);
        for kind in SurfaceKind::ALL {
            let of_kind = all
                .iter()
                .filter(|trial| trial.setting.surface == kind.name());
            let defaults = of_kind.clone().filter(|trial| trial.setting.is_default);
            assert_eq!(
                (defaults.count(), of_kind.count() > 2),
                (1, true),
                "{kind:?}"
            );
        }
        assert_eq!(trials(true).len(), SurfaceKind::ALL.len());
    }
}
