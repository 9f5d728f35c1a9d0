//! The trees of a field.

use super::TerrainError;
use super::contours::{ContourTree, Dem, build_on};
use super::field::HeightField;
use super::patches::{PatchOptions, PatchTree};
use super::quadtree::{GridQuadtree, Order, Posts, TreeOptions};
use std::cell::Cell;
use terrella_play::Progress;

/// Builds trees within a memory limit.
pub(super) struct TreeBuilds<'r> {
    /// Most that building one tree takes.
    pub memory_bytes: u64,
    pub threads: usize,
    pub progress: &'r dyn Progress,
}

impl TreeBuilds<'_> {
    /// The quadtree of a field.
    pub fn quadtree(
        &self,
        field: &HeightField,
        options: &TreeOptions,
    ) -> Result<GridQuadtree, TerrainError> {
        let built = self.with_progress(field, "quadtree", |report| {
            GridQuadtree::build(posts_of(field), options, report)
        })?;
        built.map_err(|error| TerrainError::Quadtree {
            ground: field.name.clone(),
            error,
        })
    }

    /// The contours of a field.
    pub fn contours(
        &self,
        field: &HeightField,
        dem: &Dem,
        tolerance_m: f64,
        threads: usize,
    ) -> Result<ContourTree, TerrainError> {
        let built = self.with_progress(field, "contours", |report| {
            build_on(threads, dem, tolerance_m, self.memory_bytes, report)
        })?;
        built.map_err(|error| TerrainError::Contours {
            ground: field.name.clone(),
            error,
        })
    }

    /// The patches of a field.
    pub fn patches(
        &self,
        field: &HeightField,
        dem: &Dem,
        options: &PatchOptions,
    ) -> Result<PatchTree, TerrainError> {
        let built = self.with_progress(field, "patches", |report| {
            PatchTree::build(dem, None, options, report)
        })?;
        built.map_err(|error| TerrainError::Patches {
            ground: field.name.clone(),
            error,
        })
    }

    pub fn patch_options(&self, tolerance_m: f64, threads: usize) -> PatchOptions {
        PatchOptions {
            tolerance_m,
            threads,
            budget_bytes: self.memory_bytes,
            ..PatchOptions::default()
        }
    }

    /// Does some work with a progress bar, unless the user has cancelled.
    fn with_progress<T>(
        &self,
        field: &HeightField,
        what: &str,
        work: impl FnOnce(&mut dyn FnMut(f32)) -> T,
    ) -> Result<T, TerrainError> {
        self.check_cancelled()?;
        const STEPS: u64 = 100;
        let what = format!("{what} of {}, {}", field.name, field.size());
        self.progress.begin(&what, Some(STEPS));
        let steps = Cell::new(0);
        let done = work(&mut |part| {
            let reached = (f64::from(part) * STEPS as f64) as u64;
            for _ in steps.get()..reached.min(STEPS) {
                self.progress.step();
                steps.set(steps.get() + 1);
            }
        });
        self.progress.end();
        Ok(done)
    }

    /// An error once the user has cancelled.
    pub fn check_cancelled(&self) -> Result<(), TerrainError> {
        match self.progress.cancelled() {
            true => Err(TerrainError::Interrupted),
            false => Ok(()),
        }
    }
}

fn posts_of(field: &HeightField) -> Posts<'_> {
    Posts {
        columns: field.columns as usize,
        rows: field.rows as usize,
        heights_m: &field.heights_m,
        spacing_m: field.spacing_m(),
    }
}

pub(super) fn quadtree_options(order: Order, threads: usize, memory_bytes: u64) -> TreeOptions {
    TreeOptions {
        order,
        threads,
        max_bytes: memory_bytes as usize,
        ..TreeOptions::default()
    }
}
