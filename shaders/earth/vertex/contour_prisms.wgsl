// Prisms that pages of contours lie in: behind their faces each pixel's ray is cast. `PageInstance` in src/gpu/contours.rs.

struct PrismVertex {
    // A corner of the page's prism from the eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
}

struct PagePrism {
    // The eye less the page's origin, ITRF metres: subtracted in f64.
    @location(5) eye_from_origin_m: vec3f,
    // Where the page's tree begins among all nodes.
    @location(6) root: u32,
    // Slack, cone and step of its rays: see ContourRay.
    @location(7) ray: vec3f,
}

@vertex
fn vertex(in: PrismVertex, reference: BlockInstance, page: PagePrism) -> Varying {
    var out = varying_of(reference);
    out.eye_from_origin_m = page.eye_from_origin_m;
    out.root = page.root;
    out.ray = page.ray;
    // Only what lies behind the eye is cut off: the prism is no part of the picture, the ground in it may be.
    out.clip = frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    out.clip.z = 0.5 * out.clip.w;
    return out;
}
