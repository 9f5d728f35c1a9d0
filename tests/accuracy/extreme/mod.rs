//! Extremes: formulas at the ends of their ranges, compared with arbitrary precision, and extreme views.

mod formulas;
mod horizon;
mod levels;
mod pictures;
mod projection;
mod shader;
mod time;
