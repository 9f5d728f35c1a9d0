//! Replaces `tiles.rs` if the feature `tiles` is off: types without a value, so that no code for tiles is compiled in.

use super::quality::Quality;
use super::tile_view::{TileDetail, TileView};
use super::{EarthError, EyeView};
use crate::plan::ChosenTiles;
use std::time::Duration;
use terrella_ground::globe::{Block, BlockGrid, Figure, Visibility};
use terrella_imagery::EarthLayers;
use terrella_imagery::residency::{Pool, StreamCounters, Upload};
use terrella_imagery::tile::TileKey;

/// How tiles are selected, loaded and held. Without the feature `tiles` this type has no value.
#[derive(Clone, Debug)]
pub enum TileOptions {}

impl TileOptions {
    pub(super) fn texel_px(&self) -> f64 {
        match *self {}
    }

    pub(super) fn can_be_read_by(&self, _: &wgpu::Device) -> bool {
        match *self {}
    }
}

pub(super) enum TileDriver {}

#[derive(Clone, Default)]
pub(super) struct TileLevels(());

impl TileDriver {
    pub fn new(
        options: &TileOptions,
        _: &EarthLayers,
        _: Visibility,
        _: Figure,
    ) -> Result<Self, EarthError> {
        match *options {}
    }

    pub fn set_quality(&mut self, _: &Quality) {
        match *self {}
    }

    pub fn pools(&self) -> &[Pool] {
        match *self {}
    }

    pub fn prefetch(&mut self, _: &[EyeView]) {
        match *self {}
    }

    pub fn begin(&mut self) {
        match *self {}
    }

    pub fn add(&mut self, _: &BlockGrid, _: &TileView, _: &[Block], _: &mut TileLevels) {
        match *self {}
    }

    pub fn choose(&mut self, _: &BlockGrid, _: Option<&TileView>, _: &mut ChosenTiles) {
        match *self {}
    }

    pub fn detail(&self, _: &BlockGrid, _: &TileView, _: &[Block]) -> TileDetail {
        match *self {}
    }

    pub fn upload(&mut self, _: Option<u64>, _: &mut dyn FnMut(Upload<'_>)) -> u64 {
        match *self {}
    }

    pub fn counters(&self) -> StreamCounters {
        match *self {}
    }

    pub fn missing(&self) -> std::iter::Empty<TileKey> {
        match *self {}
    }

    pub fn is_settled(&self) -> bool {
        match *self {}
    }

    pub fn wait(&mut self, _: Duration) {
        match *self {}
    }
}
