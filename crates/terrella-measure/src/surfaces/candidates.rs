//! Which surfaces are compared, with which settings.

use super::rows::{CAST, Setting};
use terrella::Subdivision;
use terrella_ground::globe::clipmap::{ClipmapOptions, Trim};
use terrella_ground::globe::contours::PageOptions;
use terrella_ground::globe::projected_grid::GridOptions;
use terrella_ground::globe::quadtree::{QuadtreeOptions, SplitRule};
use terrella_ground::globe::{SurfaceKind, SurfaceSettings};
use terrella_play::scene::DEFAULT_TOLERANCE_PX;

/// A surface to be compared.
#[derive(Clone, Debug, PartialEq)]
pub struct Candidate {
    /// How tables name it.
    pub setting: Setting,
    /// Surface with its settings.
    pub surface: SurfaceSettings,
    /// Most pixels by which drawn ground may differ, for surfaces that look at it.
    pub tolerance_px: f64,
}

impl Candidate {
    /// A surface for others to be compared with, with the tolerance of scenes.
    pub(super) fn unnamed(surface: SurfaceSettings) -> Self {
        let setting = Setting {
            surface: SurfaceKind::Blocks,
            parameter: "",
            value: String::new(),
            is_default: false,
        };
        Self {
            setting,
            surface,
            tolerance_px: DEFAULT_TOLERANCE_PX,
        }
    }
}

/// These surfaces, or all if empty, with each of their settings.
pub fn candidates(only: &[SurfaceKind]) -> Vec<Candidate> {
    let kinds = match only {
        [] => SurfaceKind::ALL,
        only => only,
    };
    kinds.iter().flat_map(|kind| of_kind(*kind)).collect()
}

fn of_kind(kind: SurfaceKind) -> Vec<Candidate> {
    let candidate = |parameter, value: String, is_default, surface, tolerance_px| Candidate {
        setting: Setting {
            surface: kind,
            parameter,
            value,
            is_default,
        },
        surface,
        tolerance_px,
    };
    let blocks = |cells| {
        let surface = kind.settings(Subdivision::Cells(cells));
        candidate("cells", cells.to_string(), cells == 48, surface, 1.0)
    };
    // Of surfaces that look at it, over the tolerance; at the default of scenes they are what a scene gets.
    let tolerances = || {
        [4.0, 2.0, 1.0, 0.5].map(|px| {
            let is_default = px == DEFAULT_TOLERANCE_PX;
            let surface = kind.settings(Subdivision::Auto);
            candidate("tolerance px", px.to_string(), is_default, surface, px)
        })
    };
    let grid = |side, on_gpu| {
        let surface = SurfaceSettings::ProjectedGrid(GridOptions {
            samples: (side, side),
            on_gpu,
            ..GridOptions::default()
        });
        let is_default = surface == kind.settings(Subdivision::Auto);
        let value = match on_gpu {
            true => side.to_string(),
            false => format!("{side} made on the CPU"),
        };
        candidate("samples", value, is_default, surface, 1.0)
    };
    let lambda = |lambda: f64| {
        let surface = SurfaceSettings::Quadtree(QuadtreeOptions {
            split_rule: SplitRule::Paper { lambda },
            ..QuadtreeOptions::default()
        });
        candidate("lambda", lambda.to_string(), false, surface, 1.0)
    };
    let leaves = |max_leaves: u32| {
        let surface = SurfaceSettings::Quadtree(QuadtreeOptions {
            max_leaves,
            ..QuadtreeOptions::default()
        });
        candidate(
            "max leaves",
            max_leaves.to_string(),
            false,
            surface,
            DEFAULT_TOLERANCE_PX,
        )
    };
    let clipmap = |samples, levels, trim| {
        let surface = SurfaceSettings::Clipmap(ClipmapOptions {
            samples,
            levels,
            trim,
            ..ClipmapOptions::default()
        });
        let is_default = surface == kind.settings(Subdivision::Auto);
        let value = match trim {
            Trim::Diamond => format!("{samples} of {levels} levels"),
            Trim::Hexagon => format!("{samples} of {levels} levels in hexagons"),
        };
        candidate("samples", value, is_default, surface, 1.0)
    };
    match kind {
        SurfaceKind::Blocks => [12, 24, 48].map(blocks).into(),
        SurfaceKind::ProjectedGrid => [(65, true), (129, true), (129, false), (257, true)]
            .map(|(side, on_gpu)| grid(side, on_gpu))
            .into(),
        SurfaceKind::Quadtree => {
            let others = [
                lambda(300.0),
                leaves(12_000),
                leaves(36_000),
                leaves(48_000),
            ];
            tolerances().into_iter().chain(others).collect()
        }
        SurfaceKind::Contours => {
            let cast = [2.0, 1.0, 0.5].map(|px| {
                let surface = SurfaceSettings::CastContours(PageOptions::default());
                candidate(CAST, px.to_string(), false, surface, px)
            });
            tolerances().into_iter().chain(cast).collect()
        }
        SurfaceKind::Clipmap => [
            (65, 12, Trim::Diamond),
            (129, 6, Trim::Diamond),
            (129, 12, Trim::Diamond),
            (129, 12, Trim::Hexagon),
            (257, 12, Trim::Diamond),
        ]
        .map(|(samples, levels, trim)| clipmap(samples, levels, trim))
        .into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_surface_has_one_default() {
        let all = candidates(&[]);
        for kind in SurfaceKind::ALL {
            let of_kind = all
                .iter()
                .filter(|candidate| candidate.setting.surface == *kind);
            let defaults = of_kind
                .clone()
                .filter(|candidate| candidate.setting.is_default);
            assert_eq!(
                (defaults.count(), of_kind.count() > 2),
                (1, true),
                "{kind:?}"
            );
        }
        // And contours cast.
        let shown = all.iter().filter(|candidate| candidate.setting.is_shown());
        assert_eq!(shown.count(), SurfaceKind::ALL.len() + 1);
        // A comma would be a column more in the table.
        let has_comma = |candidate: &Candidate| {
            (candidate.setting.parameter.to_owned() + &candidate.setting.value).contains(',')
        };
        assert!(!all.iter().any(has_comma));
    }
}
