//! Shaders: WGSL files with one concern each, assembled for a variant.
//!
//! A [`ShaderVariant`] is a value of enums: it expresses legal combinations only and enumerates all of them, for production and for tests alike.
//! Its entry file lists its files. Two constructs extend WGSL:
//!
//! - `import FILE.wgsl;` inserts that file of `shaders/`, once per shader, and `import rust::{A, B};` declares constants of Rust (`constants`), so
//!   that no number is written twice;
//! - `@if(a && !b)` before a member, a statement, a declaration or an import keeps it, to its last line, if these conditions hold; `@else` directly
//!   after it keeps the next one if they do not.
//!
//! A feature that is off is thus not in the text that the driver sees. Set `TERRELLA_SHADER_DUMP` to a folder to have every assembled shader
//! written there.
//!
//! `TERRELLA_SHADERS` names a folder that replaces the embedded files; a debug build reads `shaders/` without it ([`ShaderFiles`]). The player's
//! window redraws with the files when they change.
//!
//! # Why our own resolver
//!
//! `wesl` 0.4 (the last for this Rust) and `naga_oil` 0.23 were tried. The conditions follow WESL's syntax. The resolver is our own, 150 lines:
//!
//! - `wesl` parses all of WGSL and reports errors well, but adds 48 crates, a parser generator among them. It prints the text again with mangled
//!   names, and silently treats an undeclared condition as false.
//! - `naga_oil` adds 7 crates and returns naga's IR instead of text: there is nothing to dump, and no text length to count. Its `#ifdef` takes
//!   separate lines, which made functions here unreadable.
//! - Here a line of the driver's text is a line of a file, [`ShaderText::origins`] maps one to the other, unknown names are errors, and constants
//!   come from Rust.

mod air;
mod assemble;
mod bloom;
mod capability;
mod celestial;
mod constants;
mod develop;
mod earth;
mod files;
mod map_fade;
#[cfg(feature = "terrain")]
mod relief_constants;
mod tracks;
mod upscale;
mod value;
mod variant;
mod vertex_form;

pub use air::{AirVariant, AirViewVariant, GlowVariant};
pub use assemble::ShaderText;
pub use bloom::BloomVariant;
pub use capability::ShaderCapability;
pub use celestial::{CelestialKind, CelestialVariant};
pub use develop::DevelopVariant;
pub use earth::{
    EarthOutput, EarthVariant, PaperLayers, ShadingVariant, SunlitLayers, TruthLayers,
};
pub use files::{FILES as SHADER_FILES, ShaderError, ShaderFiles};
pub use map_fade::MapFadeVariant;
pub use tracks::{TrackKind, TracksVariant};
pub use upscale::UpscaleVariant;
pub use variant::{ShaderVariant, TargetColor};
pub use vertex_form::{PatchTiles, VertexForm};

pub(super) use variant::ShaderModule;

#[cfg(feature = "celestial")]
pub(crate) use constants::GLARE_RADIUS_RAD;
#[cfg(feature = "tiles")]
pub(crate) use constants::GLINT_ENDS_SIN;
pub(crate) use constants::LAMPS_FULL_SIN;
#[cfg(feature = "tracks")]
pub(crate) use constants::{FROM_PREVIOUS, ON_GROUND, UNCASED};
pub use constants::{
    LAMPS_OUT_SIN, PART_CELL_WORDS, PART_INDEX_BITS, TRUTH_LAND, TRUTH_SUNLIT, VIEW_ANGLES,
    VIEW_AZIMUTHS,
};
#[cfg(feature = "terrain")]
pub(crate) use relief_constants::ATLAS_COLUMNS;
