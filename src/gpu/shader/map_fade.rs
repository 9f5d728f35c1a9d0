//! The shader that blends two maps into a third.

use super::variant::ShaderVariant;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct MapFadeVariant;

impl ShaderVariant for MapFadeVariant {
    const ENTRY: &'static str = "map_fade.wgsl";

    fn all() -> Vec<Self> {
        vec![Self]
    }

    fn conditions(&self) -> Vec<(&'static str, bool)> {
        Vec::new()
    }
}
