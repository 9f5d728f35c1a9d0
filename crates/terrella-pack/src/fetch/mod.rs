//! Fetches maps from their public sources into a cache that `pack build` reads, and elements of satellites. No other part of the program accesses
//! the network.
//!
//! | file | content |
//! |---|---|
//! | `description.rs` | reading descriptions of sources |
//! | `source.rs`, `sources/` | descriptions of map sources; the built-in ones |
//! | `named.rs` | a source by its name or by the path of its description |
//! | `address.rs` | addresses of tiles, and where redirects may lead |
//! | `plan.rs` | which tiles a region needs |
//! | `http.rs` | HTTP: the only file that uses it |
//! | `token.rs` | authentication |
//! | `pace.rs`, `download.rs` | rate limits, threads, retries |
//! | `check.rs`, `cache.rs` | checks of an image before it is kept; the cache, with checksums |
//! | `layer.rs` | a complete map, and the mosaic that `pack build` reads |
//! | `elements.rs`, `element_sources/` | elements of satellites from query servers |
//! | `heights.rs` | elevation data as a GeoTIFF |

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
