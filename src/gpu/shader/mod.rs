//! Shaders: WGSL files of one concern each, put together for a variant.
//!
//! A [`ShaderVariant`] is a value of enums: it expresses legal combinations only and enumerates all of them, for production
//! and for tests alike. Its entry file lists the files that it is made of. Two things are not WGSL:
//!
//! - `import FILE.wgsl;` puts that file of `shaders/` here, once per shader, and `import rust::{A, B};` declares constants that
//!   Rust knows (`constants`), so that no number is typed twice;
//! - `@if(a && !b)` before a member, a statement, a declaration or an import keeps it where these conditions hold, down to its
//!   last line; `@else` directly after it keeps the next one where they do not.
//!
//! So what is off is not in the text that the driver sees. Set `TERRELLA_SHADER_DUMP` to a folder to have every shader written
//! there as the driver gets it.
//!
//! `TERRELLA_SHADERS` names a folder that the files are read from in place of those compiled in; a debug build reads them from
//! `shaders/` without it ([`ShaderFiles`]). The player's window draws with them again when they change.
//!
//! # Why our own resolver
//!
//! `wesl` 0.4 (the last for this Rust) and `naga_oil` 0.23 were tried. The conditions are WESL's, so that its files read alike;
//! the resolver is ours, 150 lines:
//!
//! - `wesl` parses all of WGSL and names errors well, but is 48 crates more, a parser generator among them; it prints the text
//!   again with mangled names, and a condition that nobody declared is false without a word.
//! - `naga_oil` is 7 crates more and hands over naga's IR instead of text: nothing to dump, nothing to count bytes of. Its
//!   `#ifdef` takes lines of its own, which is what made functions here unreadable.
//! - Here a line of the driver's text is a line of a file, [`ShaderText::origins`] says which, unknown names are errors, and
//!   constants come from Rust.

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

pub use air::{AirVariant, AirViewVariant, GlowVariant};
pub use assemble::ShaderText;
pub use bloom::BloomVariant;
pub use capability::ShaderCapability;
pub use celestial::{CelestialKind, CelestialVariant};
pub use develop::DevelopVariant;
pub use earth::{
    EarthOutput, EarthVariant, PaperLayers, PatchTiles, ShadingVariant, SunlitLayers, TruthLayers,
    VertexForm,
};
pub use files::{FILES as SHADER_FILES, ShaderError, ShaderFiles};
pub use map_fade::MapFadeVariant;
pub use tracks::{TrackKind, TracksVariant};
pub use upscale::UpscaleVariant;
pub use variant::{ShaderVariant, TargetColor};

pub(super) use variant::ShaderModule;

#[cfg(feature = "celestial")]
pub(crate) use constants::GLARE_RADIUS_RAD;
#[cfg(feature = "packs")]
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
