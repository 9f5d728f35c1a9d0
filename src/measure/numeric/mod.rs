//! Formulas held against arbitrary precision, and numerical methods compared by error and cost.
