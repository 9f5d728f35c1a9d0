// Where the mesh of a ground with relief is drawn.
import earth/surface_point/on_relief.wgsl;

fn surface_point(in: Varying) -> SurfacePoint {
    let ray = pixel_ray(in.clip.xy);
    // The mesh's own place, moved onto the pixel's ray, so that what is interpolated can be wrong along the ray only.
    let along = dot(in.from_eye_m, ray) / dot(ray, ray);
    return point_on_relief(in, ray, along, in.height_m, in.slope);
}
