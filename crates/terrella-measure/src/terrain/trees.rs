//! The trees of a field: from the cache, or built and then stored there.

use super::TerrainError;
use super::cache::Cache;
use super::contours::{
    ContourTree, Dem, build_on, contours_from_bytes, contours_source, contours_to_bytes,
};
use super::field::HeightField;
use super::patches::{PatchOptions, PatchTree};
use super::quadtree::{GridQuadtree, Order, Posts, TreeOptions};
use std::cell::Cell;
use terrella_play::Progress;

/// Builds trees within a memory budget, and caches them.
pub(super) struct CachedTrees<'r> {
    pub cache: Cache,
    /// Most that building one tree takes.
    pub memory_bytes: u64,
    pub threads: usize,
    pub progress: &'r dyn Progress,
}

impl CachedTrees<'_> {
    /// The quadtree of a field in the plain order, from the cache if it is there.
    pub fn quadtree(&self, field: &HeightField) -> Result<GridQuadtree, TerrainError> {
        let options = quadtree_options(Order::default(), self.threads, self.memory_bytes);
        let source = GridQuadtree::source_hash(posts_of(field), &options);
        let name = format!("{}-{}-quadtree", field.name, field.size());
        let most = self.memory_bytes as usize;
        let read = |bytes: &[u8]| GridQuadtree::from_bytes(bytes, &source, most);
        if let Some(tree) = self.cache.load(&name, read) {
            return Ok(tree);
        }
        let tree = self.build_quadtree(field, &options)?;
        self.cache.store(&name, || tree.to_bytes(&source))?;
        Ok(tree)
    }

    /// Builds the quadtree without asking the cache.
    pub fn build_quadtree(
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

    /// The contours of a field, from the cache if they are there.
    pub fn contours(
        &self,
        field: &HeightField,
        dem: &Dem,
        tolerance_m: f64,
    ) -> Result<ContourTree, TerrainError> {
        let source = contours_source(dem, tolerance_m);
        let name = format!("{}-{}-contours-{tolerance_m}m", field.name, field.size());
        let read =
            |bytes: &[u8]| contours_from_bytes(bytes, dem, &source, self.memory_beside(bytes));
        if let Some(tree) = self.cache.load(&name, read) {
            return Ok(tree);
        }
        let tree = self.build_contours(field, dem, tolerance_m, self.threads)?;
        self.cache
            .store(&name, || contours_to_bytes(&tree, &source))?;
        Ok(tree)
    }

    /// Builds the contours without asking the cache.
    pub fn build_contours(
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

    /// The bytes of a field's patches and their largest error, metres; from the cache if they are there.
    pub fn patches(
        &self,
        field: &HeightField,
        dem: &Dem,
        tolerance_m: f64,
    ) -> Result<(u64, f64), TerrainError> {
        let options = self.patch_options(tolerance_m, self.threads);
        let source = PatchTree::source_hash(dem, &options, false);
        let name = format!("{}-{}-patches-{tolerance_m}m", field.name, field.size());
        let read = |bytes: &[u8]| {
            let tree = PatchTree::from_bytes(bytes, &source, self.memory_beside(bytes))?;
            Ok::<_, super::DeserializeError>((bytes.len() as u64, tree.error_m))
        };
        if let Some(found) = self.cache.load(&name, read) {
            return Ok(found);
        }
        let tree = self.build_patches(field, dem, &options)?;
        let bytes = tree.to_bytes(&source);
        let found = (bytes.len() as u64, tree.error_m);
        self.cache.store(&name, || bytes)?;
        Ok(found)
    }

    /// The same as a tree, built in any case.
    pub fn build_patches(
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

    /// What is left of the memory beside a file that was read.
    fn memory_beside(&self, bytes: &[u8]) -> u64 {
        self.memory_bytes.saturating_sub(bytes.len() as u64)
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
