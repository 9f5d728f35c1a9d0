// The projected grid: there is no vertex buffer, and the instance index selects the tiles. A vertex index is a grid point: its ray is cast on the
// base, and the vertex is displaced along the normal by the elevation of the resident tiles. Formulas and names are those of
// crates/terrella-ground/src/globe/projected_grid/cast.rs.
//
// Single precision suffices because there is no difference of large numbers. Angles from the limb are given as sines and cosines. The place is
// stored as its offset from the place under the eye, Δm, whose relative error is a few 1e-7 at every distance. The vector from eye to ground there,
// `to_base_m`, is as small as the eye's height over the base and computed in f64. A vertex error is thus a few 1e-7 of its distance from the eye,
// plus half an ulp of its elevation (0.25 mm at 5 km).
import rust::{ATLAS_COLUMNS, GRID_LEVELS, GRID_SHARPER, GRID_TILE_CELLS, GRID_TILE_TEXELS, GRID_WINDOW_TILES, NO_SLOT, PI};

// Parameters of a frame's projected grid. Mirrored by `GridLevel` and `GridUniforms` in
// crates/terrella-ground/src/globe/projected_grid/uniforms.rs, which document the members.
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

// The direction of a point on the grid's plane, and the angle of a grid cell there.
struct GridRay {
    direction: vec3f,
    cell_rad: f32,
}

fn ray_at(at: vec2f) -> GridRay {
    let aside = grid.middle + at.x * grid.right + at.y * grid.screen_up;
    let q = length(aside);
    if q <= grid.corner {
        let part = pow(1.0 + q * q, -1.5);
        return GridRay(grid.forward + aside, sqrt(grid.cell_area * part));
    }
    let angle = min(grid.corner_rad + q - grid.corner, PI);
    let part = select(1.0, sin(angle), angle < 0.5 * PI) / q;
    return GridRay(cos(angle) * grid.forward + aside * (sin(angle) / q), sqrt(grid.cell_area * part));
}

// A place on the ground, relative to the place under the eye.
struct Foot {
    // Offset on the unit sphere of scaled space.
    offset: vec3f,
    // Derivative of θ with respect to the ray's angle, and the stretch across.
    stretch: vec2f,
}

fn foot_of(direction: vec3f) -> Foot {
    let ray = normalize(direction / grid.radii_m * grid.radii_m.x);
    let down = -dot(grid.eye_up, ray);
    let leaning = ray + grid.eye_up * down;
    let level = leaning - grid.eye_up * dot(grid.eye_up, leaning);
    let lean = length(level);
    let aside = level / max(lean, 1e-30);
    let nadir = atan2(max(lean, 1e-30), down);
    let below = grid.limb_rad - nadir;
    var sine: f32;
    var cosine: f32;
    var along: f32;
    if below > 0.0 {
        // Concentrated towards the limb: δ → δ²g/(δ + κ).
        let gain = 1.0 + grid.spread_rad / grid.limb_rad;
        let sum = below + grid.spread_rad;
        let pulled = below * (below / sum) * gain;
        let sin_pulled = sin(pulled);
        let cos_pulled = cos(pulled);
        let s = max(grid.sin_limb * cos_pulled - grid.cos_limb * sin_pulled, 0.0);
        let c = grid.cos_limb * cos_pulled + grid.sin_limb * sin_pulled;
        // sin(η_b + η); root² = sin δ sin(η_b + η).
        let sin_sum = max(grid.sin_limb * c + grid.cos_limb * s, 0.0);
        let root = sqrt(sin_pulled * sin_sum);
        let t = grid.cos_limb * grid.cos_limb / (c + root);
        sine = t * s / grid.sin_limb;
        cosine = (root * c + s * s) / grid.sin_limb;
        let unit = max(sin_pulled / max(pulled, 1e-20) * sin_sum, 1e-20);
        along = t * sqrt(gain) * (below + 2.0 * grid.spread_rad) / (sum * sqrt(sum) * sqrt(unit));
    } else {
        let width = grid.far_rad - grid.near_rad;
        var theta = grid.far_rad;
        along = 1.0;
        if grid.spread_rad > 0.0 {
            theta = grid.near_rad + width * min(-below / grid.spread_rad, 1.0);
            along = width / grid.spread_rad;
        }
        sine = sin(theta);
        cosine = cos(theta);
    }
    var out: Foot;
    // 1 − cos θ without cancellation; behind the globe's edge θ may pass a right angle.
    let versine = select(1.0 - cosine, sine * sine / (1.0 + cosine), cosine > 0.0);
    out.offset = aside * sine - grid.eye_up * versine;
    var across = along;
    let shown = select(sin(nadir), sin(grid.limb_rad + grid.spread_rad), below < -grid.spread_rad);
    if lean > 1e-6 {
        across = sine / shown;
    }
    out.stretch = vec2f(along, across);
    return out;
}

// Latitude and longitude relative to the eye's place, and the difference of the outward normals.
struct GridPlace {
    north_rad: f32,
    east_rad: f32,
    normal_offset: vec3f,
}

fn grid_place(offset: vec3f) -> GridPlace {
    let stretch = grid.radii_m.x / grid.radii_m.z;
    var out: GridPlace;
    // Geodetic latitude has the tangent (a/b) m_z / |m_xy|. Its difference from two vectors' cross product, by offsets.
    let eye_across = length(grid.eye_up.xy);
    let across = length(grid.eye_up.xy + offset.xy);
    let eye_along = stretch * grid.eye_up.z;
    let d_across = (2.0 * dot(grid.eye_up.xy, offset.xy) + dot(offset.xy, offset.xy)) / max(across + eye_across, 1e-20);
    let d_along = stretch * offset.z;
    out.north_rad = atan2(
        eye_across * d_along - eye_along * d_across,
        eye_across * across + eye_along * (eye_along + d_along),
    );
    let lon = grid.eye_lon;
    let x = eye_across + dot(lon, offset.xy);
    let y = lon.x * offset.y - lon.y * offset.x;
    out.east_rad = select(atan2(y, x), 0.0, x == 0.0 && y == 0.0);
    // n = v/|v| with v = (m_x, m_y, m_z a/b).
    let to_normal = vec3f(1.0, 1.0, stretch);
    let eye_v = grid.eye_up * to_normal;
    let d_v = offset * to_normal;
    let eye_size = length(eye_v);
    let size = length(eye_v + d_v);
    let d_size = (2.0 * dot(eye_v, d_v) + dot(d_v, d_v)) / (size + eye_size);
    out.normal_offset = (d_v - grid.eye_normal * d_size) / size;
    return out;
}

fn texel(corner: vec2u, at: vec2u) -> f32 {
    return textureLoad(height_tiles, corner + at, 0).x;
}

// The elevation of a level, and whether its tile is resident.
fn level_height(level: u32, at: GridPlace) -> vec2f {
    let here = grid.levels[level];
    var cell = here.eye_cells + vec2f(at.east_rad, at.north_rad) * here.per_radian;
    cell.x -= here.period * floor(cell.x / here.period);
    cell.y = min(cell.y, f32(here.size.y) * f32(GRID_TILE_CELLS) - 1e-3);
    let tile = floor(cell / f32(GRID_TILE_CELLS));
    if cell.y < 0.0 || tile.x >= f32(here.size.x) {
        return vec2f(0.0);
    }
    let tile_at = u32(tile.y) * here.size.x + u32(tile.x);
    if tile_at >= GRID_WINDOW_TILES {
        return vec2f(0.0);
    }
    let slot = grid.slots[(level * GRID_WINDOW_TILES + tile_at) / 4u][tile_at % 4u];
    if slot == NO_SLOT {
        return vec2f(0.0);
    }
    let within = clamp(cell - tile * f32(GRID_TILE_CELLS), vec2f(0.0), vec2f(f32(GRID_TILE_CELLS) - 1e-4));
    let whole = floor(within);
    let part = within - whole;
    let corner = vec2u(slot % ATLAS_COLUMNS, slot / ATLAS_COLUMNS) * GRID_TILE_TEXELS + vec2u(whole);
    let south = mix(texel(corner, vec2u(0u, 0u)), texel(corner, vec2u(1u, 0u)), part.x);
    let north = mix(texel(corner, vec2u(0u, 1u)), texel(corner, vec2u(1u, 1u)), part.x);
    return vec2f(mix(south, north, part.y), 1.0);
}

// The finest resident elevation, from a level (counted from 0) to coarser ones.
fn height_from(level: u32, at: GridPlace) -> f32 {
    for (var k = i32(min(level, GRID_LEVELS - 1u)); k >= 0; k--) {
        let found = level_height(u32(k), at);
        if found.y > 0.0 {
            return found.x;
        }
    }
    return 0.0;
}

// Averaged over about `spacing` radians to each side: interpolated between the levels with less and with more averaging.
fn height_at(at: GridPlace, spacing: f32) -> f32 {
    let level = clamp(log2(PI / f32(GRID_TILE_CELLS) / max(2.0 * GRID_SHARPER * spacing, 1e-12)), 0.0, f32(GRID_LEVELS - 1u));
    let coarse = u32(level);
    let height = height_from(coarse, at);
    let part = level - floor(level);
    if part == 0.0 {
        return height;
    }
    return mix(height, height_from(coarse + 1u, at), part);
}

// A vertex: its position relative to the eye, ITRF metres, its outward normal and its sources.
struct GridPoint {
    from_eye_m: vec3f,
    height_m: f32,
    normal: vec3f,
    spacing_rad: f32,
    // Slope of the ground to the east and to the north.
    slope: vec2f,
    // Latitude and longitude relative to the eye's place.
    north_rad: f32,
    east_rad: f32,
}

fn grid_point(index: u32) -> GridPoint {
    let at = grid.low + grid.step * vec2f(f32(index % grid.samples.x), f32(index / grid.samples.x));
    let ray = ray_at(at);
    let foot = foot_of(ray.direction);
    let mean = sqrt(foot.stretch.x * foot.stretch.y);
    let spacing = min(ray.cell_rad * mix(mean, max(foot.stretch.x, foot.stretch.y), grid.longer), 1.0);
    let place = grid_place(foot.offset);
    let height = height_at(place, spacing);
    var out: GridPoint;
    // D Δm + h Δn + (h − h_base) n_e + (h_base n_e + D (û − e)).
    out.from_eye_m = grid.radii_m * foot.offset + height * place.normal_offset
        + ((height - grid.base_m) * grid.eye_normal + grid.to_base_m);
    out.height_m = height;
    out.normal = grid.eye_normal + place.normal_offset;
    out.spacing_rad = spacing;
    out.north_rad = place.north_rad;
    out.east_rad = place.east_rad;
    let turn = spacing / max(length(out.normal.xy), 1e-3);
    let east = height_at(GridPlace(place.north_rad, place.east_rad + turn, vec3f(0.0)), spacing)
        - height_at(GridPlace(place.north_rad, place.east_rad - turn, vec3f(0.0)), spacing);
    let north = height_at(GridPlace(place.north_rad + spacing, place.east_rad, vec3f(0.0)), spacing)
        - height_at(GridPlace(place.north_rad - spacing, place.east_rad, vec3f(0.0)), spacing);
    out.slope = vec2f(east, north) / (2.0 * spacing * grid.radii_m.x);
    return out;
}

@vertex
fn vertex(
    @builtin(vertex_index) index: u32,
    @if(tiles) @builtin(instance_index) block: u32,
) -> Varying {
    let point = grid_point(index);
    var out: Varying;
    out.from_eye_m = point.from_eye_m;
    out.height_m = point.height_m;
    out.slope = point.slope;
    out.clip = frame.clip_from_eye * vec4f(point.from_eye_m, 1.0);
    out.center_lon = grid.eye_lon;
    out.center_lat = grid.center_lat;
    out.center_uv = grid.center_uv;
    @if(tiles) out.block = block;
    return out;
}
