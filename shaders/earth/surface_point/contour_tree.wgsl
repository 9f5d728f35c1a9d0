// Ray casting in trees of contours: the traversal of `contour_cast` in crates/terrella-ground/src/globe/contours/gpu_layout.rs, with its names.
// Positions are metres from the origin of a tree.
import rust::CONTOUR_STACK;

const NO_NODE: u32 = 0xffffffffu;

struct ContourNode {
    normal: vec3f,
    // Upper bound of the signed distance from the centroid's plane of everything drawn below the node.
    ceiling: f32,
    at: vec3f,
    // Signed distance of the plane halfway between the contours.
    middle: f32,
    // West, east, south, north: inside is where xyz·p >= w.
    walls: array<vec4f, 4>,
    // First child, counted from the root, 0 for a leaf, and number of children.
    first: u32,
    children: u32,
    thickness: f32,
    unused: f32,
    // East and north parts of the ground's normal at the corners SW, SE, NW, NE, 16 bits each.
    slopes: vec4u,
}

struct ContourRay {
    // Metres from the tree's origin.
    start: vec3f,
    // Largest distance of interest, metres.
    most: f32,
    // Of length 1.
    towards: vec3f,
    // A node whose slab is thinner than this times its distance counts as a leaf.
    cone: f32,
    // Margin by which columns are wider on all sides, metres.
    slack: f32,
    // A ray that enters the tree's column deeper in the ground than this came from below other ground: it hits nothing.
    step: f32,
}

struct ContourHit {
    // Along the ray, metres.
    t: f32,
    // NO_NODE if it hits nothing.
    node: u32,
}

// The interval of a ray inside a node's column; x > y if there is none.
fn contour_column(node: u32, ray: ContourRay) -> vec2f {
    var t0 = 0.0;
    var t1 = ray.most;
    for (var k = 0u; k < 4u; k++) {
        let wall = contour_nodes[node].walls[k];
        let lacks = wall.w - dot(wall.xyz, ray.start) - ray.slack;
        let gains = dot(wall.xyz, ray.towards);
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

// First intersection of a ray with the ground of the tree at `root`.
fn contour_cast(ray: ContourRay, root: u32) -> ContourHit {
    let nothing = ContourHit(ray.most, NO_NODE);
    let whole = contour_column(root, ray);
    let top = contour_nodes[root].normal;
    let above = dot(top, ray.start - contour_nodes[root].at) + dot(top, ray.towards) * whole.x;
    let thickness = contour_nodes[root].thickness;
    if whole.x > 0.0 && contour_nodes[root].middle - above > thickness + ray.step {
        return nothing;
    }
    var best = nothing;
    var nodes: array<u32, CONTOUR_STACK>;
    var spans: array<vec2f, CONTOUR_STACK>;
    nodes[0] = root;
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
        let over = dot(normal, ray.start - contour_nodes[index].at);
        let climbs = dot(normal, ray.towards);
        let lowest = min(over + climbs * span.x, over + climbs * span.y);
        if lowest > contour_nodes[index].ceiling {
            continue;
        }
        let children = contour_nodes[index].children;
        let is_fine = contour_nodes[index].thickness <= ray.cone * span.x;
        if children == 0u || is_fine || height + 4u > CONTOUR_STACK {
            let t = (middle - over) / climbs;
            let depth = middle - over - climbs * span.x;
            if depth >= 0.0 {
                // Through the wall of the column, or from inside the ground.
                if span.x > 0.0 && span.x <= whole.x && depth > ray.step {
                    return nothing;
                }
                best = ContourHit(span.x, index);
            } else if climbs < 0.0 && t <= span.y && t < best.t {
                best = ContourHit(max(t, span.x), index);
            }
            continue;
        }
        // Near children on top of the stack.
        let first = root + contour_nodes[index].first;
        let bottom = height;
        for (var k = first; k < first + children; k++) {
            let part = contour_column(k, ray);
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

// Slope of the ground to the east and to the north at a place inside a node's column, interpolated between its corners.
fn contour_slope(node: u32, p: vec3f) -> vec2f {
    var inside: array<f32, 4>;
    for (var k = 0u; k < 4u; k++) {
        let wall = contour_nodes[node].walls[k];
        inside[k] = max(dot(wall.xyz, p) - wall.w, 0.0);
    }
    let u = inside[0] / max(inside[0] + inside[1], 1e-6);
    let v = inside[2] / max(inside[2] + inside[3], 1e-6);
    let corners = contour_nodes[node].slopes;
    let south = mix(unpack2x16snorm(corners.x), unpack2x16snorm(corners.y), u);
    let north = mix(unpack2x16snorm(corners.z), unpack2x16snorm(corners.w), u);
    let normal = mix(south, north, v);
    return -normal / sqrt(max(1.0 - dot(normal, normal), 1e-4));
}
