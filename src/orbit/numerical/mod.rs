//! Motion under forces, integrated.

mod integrate;
