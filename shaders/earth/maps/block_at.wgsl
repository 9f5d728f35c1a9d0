import rust::{BLOCK_COLUMNS, BLOCK_ROWS};

// The block that a place of the whole map lies in.
fn block_at(whole_uv: vec2f) -> u32 {
    let row = min(u32(max(f32(BLOCK_ROWS) * whole_uv.y, 0.0)), BLOCK_ROWS - 1u);
    let column = min(u32(f32(BLOCK_COLUMNS) * fract(whole_uv.x)), BLOCK_COLUMNS - 1u);
    return BLOCK_COLUMNS * row + column;
}

// Texture coordinates of its centre.
fn block_center(block: u32) -> vec2f {
    let cell = vec2f(f32(block % BLOCK_COLUMNS), f32(block / BLOCK_COLUMNS));
    return (cell + 0.5) / vec2f(f32(BLOCK_COLUMNS), f32(BLOCK_ROWS));
}
