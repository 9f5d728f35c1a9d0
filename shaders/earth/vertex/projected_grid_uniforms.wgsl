// What a frame's projected grid is made from. Mirrored by `GridLevel` and `GridUniforms` in crates/terrella-ground/src/globe/projected_grid/uniforms.rs,
// where members are explained.
import rust::{GRID_LEVELS, GRID_WINDOW_TILES};

struct GridLevel {
    eye_cells: vec2f,
    per_radian: f32,
    period: f32,
    size: vec2u,
    padding: vec2u,
}

struct GridUniforms {
    forward: vec3f,
    corner: f32,
    middle: vec3f,
    corner_rad: f32,
    right: vec3f,
    cell_area: f32,
    screen_up: vec3f,
    longer: f32,
    eye_up: vec3f,
    limb_rad: f32,
    eye_normal: vec3f,
    sin_limb: f32,
    to_base_m: vec3f,
    cos_limb: f32,
    radii_m: vec3f,
    base_m: f32,
    eye_lon: vec2f,
    low: vec2f,
    step: vec2f,
    samples: vec2u,
    near_rad: f32,
    far_rad: f32,
    spread_rad: f32,
    eye_lat: f32,
    center_lat: vec2f,
    center_uv: vec2f,
    levels: array<GridLevel, GRID_LEVELS>,
    // GRID_WINDOW_TILES a level, four to a vector. One array: WebGL 2 has no arrays of arrays.
    slots: array<vec4u, GRID_WINDOW_TILES / 4u * GRID_LEVELS>,
}
