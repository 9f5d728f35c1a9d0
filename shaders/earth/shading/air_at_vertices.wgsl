// The air's light, sampled at the vertices of the block sphere and interpolated: for cells where the difference is invisible, which
// src/plan/cells.rs selects, and for an eye outside the air. Its factor, the albedo of the surrounding ground, is sampled for each pixel.
import earth/shading/light.wgsl;
@if(clouds) import earth/shading/air_above_clouds.wgsl;

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
    @if(clouds) out.of_clouds = air_above_clouds(lifted_before(at).up, ray, air.sun);
    return out;
}

fn air_between_vertices(in: Varying) -> AirAtPoint {
    var out: AirAtPoint;
    out.through = in.through;
    out.black = in.black;
    out.bounce = in.bounce;
    out.sun = in.sun;
    out.sky = in.sky;
    @if(clouds) out.of_clouds = AirOfClouds(in.sun_on_clouds, in.sky_on_clouds, in.through_to_clouds, in.black_above_clouds, in.bounce_above_clouds);
    return out;
}
