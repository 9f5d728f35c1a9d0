//! The extremes: formulas at the ends of their ranges, compared with arbitrary precision, and pictures that nobody
//! would ask for.

mod formulas;
mod horizon;
mod levels;
mod pictures;
mod projection;
mod shader;
mod time;
