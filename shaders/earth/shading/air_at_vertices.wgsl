// What the air does, looked up at the vertices of the block sphere and interpolated between them: for cells where the difference is not
// seen, which src/plan/cells.rs chooses, and for an eye outside the air. What it is multiplied by, the albedo of the ground about, is
// looked up for each pixel.
import earth/shading/light.wgsl;

fn air_at_vertex(at: SurfacePoint) -> AirAtPoint {
    let ray = -normalize(at.to_eye);
    let mu = clamp(-dot(ray, at.up), 0.0, 1.0);
    let mu_s = dot(at.up, air.sun);
    let x = ground_coordinate(mu);
    let parts = scattered_parts(x, mu, ray, air.sun, mu_s);
    var out: AirAtPoint;
    out.through = through_at(x);
    out.black = parts.black.rgb;
    out.bounce = parts.bounce;
    out.sun = sunlight(mu_s, OF_GROUND);
    out.sky = sunlight(mu_s, OF_SKY);
    @if(clouds) out.sun_on_clouds = sunlight(dot(lifted_before(at).up, air.sun), OF_CLOUDS);
    return out;
}

fn air_between_vertices(in: Varying) -> AirAtPoint {
    var out: AirAtPoint;
    out.through = in.through;
    out.black = in.black;
    out.bounce = in.bounce;
    out.sun = in.sun;
    out.sky = in.sky;
    @if(clouds) out.sun_on_clouds = in.sun_on_clouds;
    return out;
}
