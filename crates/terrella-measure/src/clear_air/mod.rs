//! The drawn light of clear air, compared with tables of a radiative-transfer program.
//!
//! The tables are outside the repository, in `../shared/oracle` (its README explains the columns): spherical air, US Standard Atmosphere 1976,
//! ozone, all orders of scattering, 41 wavelengths converted to linear sRGB with the Sun as white. They are independent of this program. Their
//! `_scalar` columns, light without polarisation, are compared as ratios drawn : true in channels brighter than [`DARKEST`].
//!
//! | file | content |
//! |---|---|
//! | `table` | rows of the tables |
//! | `place` | a row's eye, line of sight and Sun over a figure of the Earth |
//! | `draw` | radiance of a drawn Earth along those lines |
//! | `disc` | brightness of the whole Earth by phase |
//! | `errors` | errors by kind of view, their bounds, and the table of them |
//! | `color` | CIEDE2000 |

mod color;
mod disc;
mod draw;
mod errors;
mod place;
mod table;

pub use color::{color_difference, lab_of_linear};
pub use disc::{DiscLight, DiscPhase};
pub use draw::{LightRenderer, grey_ground, stored_albedo};
pub use errors::{AirErrors, Bound, DARKEST, RowError, ViewGroup};
pub use place::PlacedView;
pub use table::{AirRow, AirSet, AirTable, TableError, read_table};
