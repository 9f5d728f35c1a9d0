//! Maps fetched from their public sources into a cache that `pack build` reads, and elements of satellites. Nothing else of the program reaches the network.
//!
//! | file | what |
//! |---|---|
//! | `description.rs` | reading descriptions of whatever source |
//! | `source.rs`, `sources/` | descriptions of sources of maps; those that come with the program |
//! | `named.rs` | a source by its name or by the path of its description |
//! | `address.rs` | addresses of tiles, and where redirects may lead |
//! | `plan.rs` | which tiles a region needs |
//! | `http.rs` | HTTP: the only file that uses it |
//! | `token.rs` | who asks, where a server wants to know |
//! | `pace.rs`, `download.rs` | how fast, by how many threads, and what is asked for again |
//! | `check.rs`, `cache.rs` | what a picture must be before it is kept; what is kept, with checksums |
//! | `layer.rs` | all of it for one map, and the mosaic that `pack build` reads |
//! | `elements.rs`, `element_sources/` | elements of satellites from servers that answer queries |
//! | `heights.rs` | heights written as a GeoTIFF |

mod address;
mod cache;
mod check;
mod description;
mod download;
mod elements;
mod error;
mod heights;
mod http;
mod layer;
mod named;
mod pace;
mod plan;
mod source;
mod token;

pub use description::MAX_SOURCE_BYTES;
pub use download::Fetched;
pub use elements::{ElementMedia, ElementQuery, ElementSource, ElementsError, FetchedElements};
pub use error::FetchError;
pub use heights::write_heights;
pub use http::ClientOptions;
pub use layer::{Estimate, FetchOptions, Layer, LayerDone, Request};
pub use named::{find_source, source_names};
pub use plan::Fineness;
pub use source::{
    Files, Gentleness, ListedFile, MapSource, Media, SourceLayer, Tiles, TimeStep, Times,
};
