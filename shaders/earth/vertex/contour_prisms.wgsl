// Prisms of contour pages: each pixel's ray is cast behind their faces. `PageInstance` in src/gpu/contours.rs.

struct PrismVertex {
    // A corner of the page's prism relative to the eye, ITRF metres: subtracted in f64.
    @location(0) from_eye_m: vec3f,
}

struct PagePrism {
    // From the page's origin to the eye, ITRF metres: subtracted in f64.
    @location(5) eye_from_origin_m: vec3f,
    // Index of the page's root among all nodes.
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
    // Only parts behind the eye are clipped: the prism itself is invisible, but the ground in it may be visible.
    out.clip = frame.clip_from_eye * vec4f(in.from_eye_m, 1.0);
    out.clip.z = 0.5 * out.clip.w;
    return out;
}
