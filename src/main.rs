//! The `terrella` command.
fn main() {}
