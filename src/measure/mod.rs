//! Measuring: how long a picture takes, how wrong it is, and where a formula stops being stable.
//!
//! | module | what |
//! |---|---|
//! | [`reference`] | the true picture: ray casting in f64 on the processor |
//! | [`numeric`] | formulas held against arbitrary precision, methods compared by error and cost |
//! | [`extreme`] | pictures that nobody would ask for, and what they must show |

pub mod extreme;
pub mod numeric;
pub mod reference;
