//! Cells of the ground with their coverage, and where a flight keeps those of its scene.

use std::sync::OnceLock;
#[cfg(feature = "window")]
use std::sync::atomic::{AtomicBool, Ordering};
use terrella::frames::Epoch;
use terrella_orbit::{Cell, CellCoverage};

/// What of a region is covered within a span.
#[derive(Clone, Debug)]
pub(crate) struct CoverageCells {
    /// First and last instant.
    pub span: (Epoch, Epoch),
    /// The western edge, radians.
    pub west_rad: f64,
    /// Row by row from the south, in each from west to east.
    pub cells: Vec<(Cell, CellCoverage)>,
}

impl CoverageCells {
    /// How long is looked at, seconds.
    pub fn length_s(&self) -> f64 {
        (self.span.1 - self.span.0).to_seconds()
    }

    /// The greatest number of views that a cell has.
    pub fn most_views(&self) -> u32 {
        let counts = self.cells.iter().map(|(_, one)| one.accesses);
        counts.max().unwrap_or(0)
    }
}

/// The cells of a flight's scene, computed once.
#[derive(Default)]
pub(crate) struct SharedCoverage {
    cells: OnceLock<CoverageCells>,
    /// Whether a thread computes them, for which nobody waits.
    #[cfg(feature = "window")]
    is_behind: AtomicBool,
}

impl SharedCoverage {
    /// The cells, if they are computed.
    pub fn get(&self) -> Option<&CoverageCells> {
        self.cells.get()
    }

    /// Keeps these, unless there are some; answers those that are kept.
    pub fn keep(&self, cells: CoverageCells) -> &CoverageCells {
        self.cells.get_or_init(|| cells)
    }

    /// Whether a thread computes them.
    pub fn is_behind(&self) -> bool {
        #[cfg(feature = "window")]
        return self.is_behind.load(Ordering::Acquire);
        #[cfg(not(feature = "window"))]
        false
    }

    /// From now on nobody waits for them: a thread computes them.
    #[cfg(feature = "window")]
    pub fn leave_to_thread(&self) {
        self.is_behind.store(true, Ordering::Release);
    }
}
