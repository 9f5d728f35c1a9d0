//! The light of the clear air as it is drawn, compared with tables of a radiative-transfer program.
//!
//! The tables lie outside the repository, in `../shared/oracle` (its README says what each column is): spherical air, US
//! Standard Atmosphere 1976, ozone, all orders of scattering, 41 wavelengths to linear sRGB with the Sun as white. No
//! number of this program went into them. Compared are their `_scalar` columns, light without polarisation, as ratios drawn :
//! true in channels brighter than [`DARKEST`].
//!
//! | file | what |
//! |---|---|
//! | `table` | rows of the tables |
//! | `place` | a row's eye, line of sight and Sun over a figure of the Earth |
//! | `draw` | what an Earth that a graphics adapter draws sends along those lines |
//! | `disc` | how bright the whole Earth is by phase |
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
