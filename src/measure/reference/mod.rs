//! The true picture: exact ray casting on the processor in f64. It shares constants and maps with the drawables, no code.
