//! `[earth.clipmap]`, `[earth.contours]`, `[earth.projected_grid]` and `[earth.quadtree]`: settings of individual surfaces.

use super::error::{SceneError, printable};
use super::field::{Field, range_text, written};
use super::keys::RawEarth;
use super::keys::{CLIPMAP, CONTOURS, PROJECTED_GRID, QUADTREE};
use super::keys::{CLIPMAP_LEVELS, CLIPMAP_SAMPLES, GRID_SAMPLES, MAX_LEAVES, QUADTREE_LAMBDA};
use super::table::Only;
use super::text::SceneText;
use terrella_ground::globe::clipmap::{ClipmapOptions, Trim};
use terrella_ground::globe::contours::PageOptions;
use terrella_ground::globe::projected_grid::GridOptions;
use terrella_ground::globe::quadtree::{QuadtreeOptions, SplitRule};
use terrella_ground::globe::{ContourDrawing, SurfaceKind, SurfaceSettings};
use toml::{Spanned, Value};

impl SceneText<'_> {
    /// The terrain surface with its settings.
    pub(super) fn surface_settings(
        &self,
        earth: &RawEarth,
        surface: SurfaceKind,
    ) -> Result<SurfaceSettings, SceneError> {
        let clipmap = earth.clipmap();
        self.only_for(&clipmap, CLIPMAP, surface == SurfaceKind::Clipmap)?;
        let grid = earth.projected_grid();
        self.only_for(&grid, PROJECTED_GRID, surface == SurfaceKind::ProjectedGrid)?;
        let contours = earth.contours();
        self.only_for(&contours, CONTOURS, surface == SurfaceKind::Contours)?;
        let quadtree = earth.quadtree();
        self.only_for(&quadtree, QUADTREE, surface == SurfaceKind::Quadtree)?;
        if self.contours(&contours)? == ContourDrawing::Cast {
            return Ok(SurfaceSettings::CastContours(PageOptions::default()));
        }
        let cells = self.subdivision(&earth.subdivision())?;
        let mut settings = surface.settings(cells);
        match &mut settings {
            SurfaceSettings::Clipmap(options) => self.clipmap(&clipmap, options)?,
            SurfaceSettings::ProjectedGrid(options) => self.grid(&grid, options)?,
            SurfaceSettings::Quadtree(options) => self.quadtree(&quadtree, options)?,
            _ => {}
        }
        Ok(settings)
    }

    fn only_for(
        &self,
        table: &Field<'_, Value>,
        only: &Only,
        is_drawn: bool,
    ) -> Result<(), SceneError> {
        let advice = format!(
            "this table is {}; leave it out, or write that below [earth]",
            only.why
        );
        match is_drawn {
            true => Ok(()),
            false => self.idle(table, only.why, advice),
        }
    }

    fn clipmap(
        &self,
        table: &Field<'_, Value>,
        options: &mut ClipmapOptions,
    ) -> Result<(), SceneError> {
        for (key, value) in self.entries(table)? {
            let must = match (key.as_str(), value) {
                ("samples", Value::Integer(samples)) if CLIPMAP_SAMPLES.contains(samples) => {
                    options.samples = *samples as u32;
                    continue;
                }
                ("levels", Value::Integer(levels)) if CLIPMAP_LEVELS.contains(levels) => {
                    options.levels = *levels as u32;
                    continue;
                }
                ("trimming", Value::String(word)) if trim_of(word).is_some() => {
                    options.trim = trim_of(word).unwrap_or_default();
                    continue;
                }
                ("samples", _) => "samples along an edge of a level must be 65, 129 or 257".into(),
                ("levels", _) => {
                    let span = range_text(&CLIPMAP_LEVELS);
                    format!("levels must be a whole number from {span}, besides the globe's")
                }
                ("trimming", _) => "trimming must be \"diamond\" or \"hexagon\"".into(),
                (other, _) => {
                    let other = printable(other);
                    format!("a clipmap has samples, levels and trimming, not {other}")
                }
            };
            return Err(self.reject(table, format!("{must}; write them like {}", like(table))));
        }
        table.note(Ok(format!(
            "{{ samples = {}, levels = {}, trimming = \"{}\" }}",
            options.samples,
            options.levels,
            written(&options.trim)
        )));
        Ok(())
    }

    fn grid(&self, table: &Field<'_, Value>, options: &mut GridOptions) -> Result<(), SceneError> {
        for (key, value) in self.entries(table)? {
            let must = match (key.as_str(), value) {
                ("samples", Value::Array(sides)) if sides_of(sides).is_some() => {
                    options.samples = sides_of(sides).unwrap_or(options.samples);
                    continue;
                }
                ("on_gpu", Value::Boolean(on_gpu)) => {
                    options.on_gpu = *on_gpu;
                    continue;
                }
                ("samples", _) => {
                    let span = range_text(&GRID_SAMPLES);
                    format!("samples must be [across, down], whole numbers from {span}")
                }
                ("on_gpu", _) => "on_gpu must be true or false".into(),
                (other, _) => {
                    let other = printable(other);
                    format!("a projected grid has samples and on_gpu, not {other}")
                }
            };
            return Err(self.reject(table, format!("{must}; write them like {}", like(table))));
        }
        table.note(Ok(format!(
            "{{ samples = [{}, {}], on_gpu = {} }}",
            options.samples.0, options.samples.1, options.on_gpu
        )));
        Ok(())
    }

    fn quadtree(
        &self,
        table: &Field<'_, Value>,
        options: &mut QuadtreeOptions,
    ) -> Result<(), SceneError> {
        for (key, value) in self.entries(table)? {
            let number = match value {
                Value::Integer(whole) => Some(*whole as f64),
                Value::Float(number) => Some(*number),
                _ => None,
            };
            let must = match (key.as_str(), value) {
                ("lambda", _) if number.is_some_and(|n| QUADTREE_LAMBDA.contains(&n)) => {
                    let lambda = number.unwrap_or_default();
                    options.split_rule = SplitRule::Paper { lambda };
                    continue;
                }
                ("culling", Value::Boolean(culling)) => {
                    options.is_culled = *culling;
                    continue;
                }
                ("max_leaves", Value::Integer(leaves)) if MAX_LEAVES.contains(leaves) => {
                    options.max_leaves = *leaves as u32;
                    continue;
                }
                ("lambda", _) => {
                    let span = range_text(&QUADTREE_LAMBDA);
                    format!("lambda must be from {span}, metres of distance for a metre of error")
                }
                ("culling", _) => "culling must be true or false".into(),
                ("max_leaves", _) => {
                    let span = range_text(&MAX_LEAVES);
                    format!("max_leaves must be a whole number from {span}")
                }
                (other, _) => {
                    let other = printable(other);
                    format!("a quadtree has lambda, culling and max_leaves, not {other}")
                }
            };
            return Err(self.reject(table, format!("{must}; write them like {}", like(table))));
        }
        let lambda = match options.split_rule {
            SplitRule::Paper { lambda } => format!("lambda = {lambda}, "),
            _ => String::new(),
        };
        table.note(Ok(format!(
            "{{ {lambda}culling = {}, max_leaves = {} }}",
            options.is_culled, options.max_leaves
        )));
        Ok(())
    }

    fn contours(&self, table: &Field<'_, Value>) -> Result<ContourDrawing, SceneError> {
        let mut drawing = ContourDrawing::default();
        for (key, value) in self.entries(table)? {
            let must = match (key.as_str(), value) {
                ("drawn", Value::String(word)) if drawing_of(word).is_some() => {
                    drawing = drawing_of(word).unwrap_or_default();
                    continue;
                }
                ("drawn", _) => "drawn must be \"patches\" or \"cast\"".into(),
                (other, _) => format!("contours have drawn, not {}", printable(other)),
            };
            return Err(self.reject(table, format!("{must}; write it like {}", like(table))));
        }
        table.note(Ok(format!("{{ drawn = \"{}\" }}", written(&drawing))));
        Ok(drawing)
    }

    /// The keys of a nested table; empty if it is absent.
    fn entries<'v>(
        &self,
        table: &Field<'v, Value>,
    ) -> Result<impl Iterator<Item = (&'v String, &'v Value)>, SceneError> {
        let entries = match table.given.map(Spanned::get_ref) {
            None => None,
            Some(Value::Table(entries)) => Some(entries),
            Some(_) => return Err(self.reject(table, format!("must be {}", table.of))),
        };
        Ok(entries.into_iter().flatten())
    }
}

/// An example of the table in scene syntax.
fn like(table: &Field<'_, Value>) -> &'static str {
    table.of.trim_start_matches("a table like ")
}

fn trim_of(word: &str) -> Option<Trim> {
    let trims = [Trim::Diamond, Trim::Hexagon];
    trims.into_iter().find(|trim| written(trim) == word)
}

fn drawing_of(word: &str) -> Option<ContourDrawing> {
    let drawings = [ContourDrawing::Patches, ContourDrawing::Cast];
    drawings
        .into_iter()
        .find(|drawing| written(drawing) == word)
}

fn sides_of(sides: &[Value]) -> Option<(u32, u32)> {
    let side = |value: &Value| {
        let side = value
            .as_integer()
            .filter(|side| GRID_SAMPLES.contains(side));
        side.map(|side| side as u32)
    };
    match sides {
        [across, down] => Some((side(across)?, side(down)?)),
        _ => None,
    }
}

/// Why a surface ignores `tolerance_px`; `None` if it uses it.
pub(super) fn without_tolerance(settings: &SurfaceSettings) -> Option<&'static str> {
    match settings {
        SurfaceSettings::Blocks(_) => Some("blocks have the same cells everywhere"),
        SurfaceSettings::ProjectedGrid(_) => {
            Some("a projected grid has the same samples everywhere")
        }
        SurfaceSettings::Quadtree(QuadtreeOptions {
            split_rule: SplitRule::Paper { .. },
            ..
        }) => Some("lambda is given"),
        _ => None,
    }
}
