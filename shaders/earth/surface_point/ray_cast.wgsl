// Where the pixel's ray meets the contours of the page whose prism is drawn; no pixel where it meets none.
import earth/surface_point/on_relief.wgsl;
import earth/surface_point/contour_tree.wgsl;

fn surface_point(in: Varying) -> SurfacePoint {
    let ray = pixel_ray(in.clip.xy);
    let ray_length = length(ray);
    let in_page = ContourRay(in.eye_from_origin_m, 1e30, ray / ray_length, in.ray.y, in.ray.x, in.ray.z);
    let hit = contour_cast(in_page, in.root);
    if hit.node == NO_NODE {
        discard;
    }
    let along = hit.t / ray_length;
    let radii = along / frame.radius_m;
    let scaled = ray * vec3f(1.0, 1.0, frame.polar_stretch);
    // |p|² − 1 without cancellation.
    let above = frame.above + radii * (2.0 * dot(frame.eye_scaled, scaled) + radii * dot(scaled, scaled));
    let height_m = frame.radius_m * above / (1.0 + sqrt(max(1.0 + above, 0.0)));
    let slope = contour_slope(hit.node, in_page.start + hit.t * in_page.towards);
    return point_on_relief(in, ray, along, height_m, slope);
}
