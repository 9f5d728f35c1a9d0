//! Curves of real orbits.
