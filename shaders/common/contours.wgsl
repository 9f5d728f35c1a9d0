// Casting rays at contours: the walk of `cast_flat` in src/globe/contours/flat.rs. Whoever imports this declares
//   var<storage, read> contour_nodes: array<ContourNode>;
// Positions are metres from the origin of the DEM.

struct ContourNode {
    normal: vec3f,
    // Nothing drawn below rises over this signed distance from the centroid's plane.
    ceiling: f32,
    at: vec3f,
    // Signed distance of the plane halfway between the contours.
    middle: f32,
    // West, east, south, north: inside is where xyz·p >= w.
    walls: array<vec4f, 4>,
    // First child, 0 for a leaf, and how many.
    first: u32,
    children: u32,
    thickness: f32,
    unused: f32,
}

struct ContourHit {
    // Along the ray, metres.
    t: f32,
    // 0xffffffff if it meets nothing.
    node: u32,
}

const CONTOUR_STACK: u32 = 64u;

// The stretch of a ray inside a node's column; x > y if there is none.
fn contour_column(node: u32, origin: vec3f, towards: vec3f, most: f32) -> vec2f {
    var t0 = 0.0;
    var t1 = most;
    for (var k = 0u; k < 4u; k++) {
        let wall = contour_nodes[node].walls[k];
        let lacks = wall.w - dot(wall.xyz, origin);
        let gains = dot(wall.xyz, towards);
        if gains > 0.0 {
            t0 = max(t0, lacks / gains);
        } else if gains < 0.0 {
            t1 = min(t1, lacks / gains);
        } else if lacks > 0.0 {
            return vec2f(1.0, 0.0);
        }
    }
    return vec2f(t0, t1);
}

// Where a ray first meets the ground. `towards` has length 1; a node whose slab is thinner than `cone` times its distance
// counts as a leaf.
fn contour_cast(origin: vec3f, towards: vec3f, most: f32, cone: f32) -> ContourHit {
    var best = ContourHit(most, 0xffffffffu);
    var nodes: array<u32, CONTOUR_STACK>;
    var spans: array<vec2f, CONTOUR_STACK>;
    let whole = contour_column(0u, origin, towards, most);
    nodes[0] = 0u;
    spans[0] = whole;
    var height = select(0u, 1u, whole.x <= whole.y);
    while height > 0u {
        height--;
        let index = nodes[height];
        let span = spans[height];
        if span.x >= best.t {
            continue;
        }
        let normal = contour_nodes[index].normal;
        let middle = contour_nodes[index].middle;
        let over = dot(normal, origin - contour_nodes[index].at);
        let climbs = dot(normal, towards);
        let lowest = min(over + climbs * span.x, over + climbs * span.y);
        if lowest > contour_nodes[index].ceiling {
            continue;
        }
        let first = contour_nodes[index].first;
        let children = contour_nodes[index].children;
        let is_fine = contour_nodes[index].thickness <= cone * span.x;
        if children == 0u || is_fine || height + 4u > CONTOUR_STACK {
            let t = (middle - over) / climbs;
            if over + climbs * span.x - middle <= 0.0 {
                // Through the wall of the column, or from inside the ground.
                best = ContourHit(span.x, index);
            } else if climbs < 0.0 && t <= span.y && t < best.t {
                best = ContourHit(max(t, span.x), index);
            }
            continue;
        }
        // Near children on top.
        let bottom = height;
        for (var k = first; k < first + children; k++) {
            let part = contour_column(k, origin, towards, most);
            if part.x <= part.y {
                var at = height;
                while at > bottom && spans[at - 1u].x < part.x {
                    nodes[at] = nodes[at - 1u];
                    spans[at] = spans[at - 1u];
                    at--;
                }
                nodes[at] = k;
                spans[at] = part;
                height++;
            }
        }
    }
    return best;
}
