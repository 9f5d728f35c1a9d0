// A model of a spacecraft: metallic-roughness materials in linear light, lit by the Sun, the Moon and the sunlit Earth.
//
// Khronos, glTF 2.0 Specification, Appendix B: the diffuse part, microfacets after GGX, Fresnel after Schlick. The visibility of
// microfacets is the height-correlated one of Smith (Heitz 2014, "Understanding the Masking-Shadowing Function", JCGT 3(2)).
import common/displayed.wgsl;
import rust::PI;

// | group | binding | what                       | when   |
// |-------|---------|----------------------------|--------|
// | 0     | 0       | this craft                 | always |
// | 1     | 0       | the material               | always |
// | 1     | 1, 2    | base colour                | always |
// | 1     | 3, 4    | roughness and metalness    | always |
// | 1     | 5, 6    | light of its own           | always |
// | 1     | 7, 8    | normals                    | normal_map |
@group(0) @binding(0) var<uniform> craft: ModelFrame;
@group(1) @binding(0) var<uniform> material: ModelMaterial;
@group(1) @binding(1) var base_color_texture: texture_2d<f32>;
@group(1) @binding(2) var base_color_sampler: sampler;
@group(1) @binding(3) var surface_texture: texture_2d<f32>;
@group(1) @binding(4) var surface_sampler: sampler;
@group(1) @binding(5) var emissive_texture: texture_2d<f32>;
@group(1) @binding(6) var emissive_sampler: sampler;
@if(normal_map) @group(1) @binding(7) var normal_texture: texture_2d<f32>;
@if(normal_map) @group(1) @binding(8) var normal_sampler: sampler;

// Mirrored by `ModelFrame` in crates/terrella-play/src/model_layer/uniforms.rs; a test compares the offsets. All axes are the model's.
struct ModelFrame {
    // Transform from model metres to clip space.
    clip_from_model: mat4x4f,
    // Unit vector to the Sun, and the fraction of its disc that Earth and Moon do not hide, 0…1.
    sun: vec3f,
    sunlight: f32,
    // Unit vector to the Moon, and its light; the Sun's is 1.
    moon: vec3f,
    moonlight: f32,
    // The eye, model metres, and the exposure factor of light on 8-bit targets.
    eye: vec3f,
    exposure: f32,
    // Unit vector to the Earth's centre, and the sine of the angle between it and the limb.
    down: vec3f,
    limb_sine: f32,
    // Mean light of the Earth's disc as seen from the craft; a white diffuse sheet that faces the Sun is 1.
    earth_light: vec3f,
    padding: f32,
}

// Mirrored by `ModelMaterial` there.
struct ModelMaterial {
    base_color: vec4f,
    emissive: vec3f,
    metallic: f32,
    roughness: f32,
    // Alpha below which nothing is drawn.
    alpha_cutoff: f32,
    // Multiplies normals of the texture across the surface.
    normal_scale: f32,
    padding: f32,
}

struct ModelVertex {
    @location(0) position_m: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    // Along the first texture coordinate, and the sign of the bitangent; all 0 where the model gives none.
    @if(normal_map) @location(3) tangent: vec4f,
}

struct Varying {
    @builtin(position) clip: vec4f,
    @location(0) position_m: vec3f,
    @location(1) normal: vec3f,
    @location(2) uv: vec2f,
    @if(normal_map) @location(3) tangent: vec4f,
}

// Surface properties for shading.
struct Surface {
    normal: vec3f,
    to_eye: vec3f,
    diffuse: vec3f,
    // Reflectance along the normal.
    f0: vec3f,
    // Square of the perceptual roughness.
    alpha: f32,
}

@vertex
fn vertex(in: ModelVertex) -> Varying {
    var out: Varying;
    out.clip = craft.clip_from_model * vec4f(in.position_m, 1.0);
    out.position_m = in.position_m;
    out.normal = in.normal;
    out.uv = in.uv;
    @if(normal_map) out.tangent = in.tangent;
    return out;
}

// The normal of a texel (glTF 2.0, section 3.9.3) on a surface with the unit normal `n`. The model gives the tangent t and the bitangent
// b = n × t · w, or they follow from how place and texture coordinates change from pixel to pixel. With dp = p_u du + p_v dv for a step
// across and one down, t is p_u = (dp₁ dv₂ − dp₂ dv₁)/(du₁ dv₂ − du₂ dv₁). v grows downwards in a picture and y upwards:
// b is −p_v = (dp₁ du₂ − dp₂ du₁)/(du₁ dv₂ − du₂ dv₁).
@if(normal_map)
fn mapped_normal(in: Varying, n: vec3f) -> vec3f {
    let texel = textureSample(normal_texture, normal_sampler, in.uv).xyz * 2.0 - 1.0;
    let dp_1 = dpdx(in.position_m);
    let dp_2 = dpdy(in.position_m);
    let duv_1 = dpdx(in.uv);
    let duv_2 = dpdy(in.uv);
    // Lengths do not count.
    let side = select(1.0, -1.0, duv_1.x * duv_2.y - duv_2.x * duv_1.y < 0.0);
    var t = side * (dp_1 * duv_2.y - dp_2 * duv_1.y);
    var b = side * (dp_1 * duv_2.x - dp_2 * duv_1.x);
    if in.tangent.w != 0.0 {
        t = in.tangent.xyz;
        b = cross(n, t) * in.tangent.w;
    }
    let across = t - n * dot(n, t);
    let up = b - n * dot(n, b);
    // Without texture coordinates there is no direction.
    if dot(across, across) < 1e-30 || dot(up, up) < 1e-30 {
        return n;
    }
    let xy = texel.xy * material.normal_scale;
    return normalize(xy.x * normalize(across) + xy.y * normalize(up) + texel.z * n);
}

// Light of a small source that the surface throws to the eye. An irradiance of π is the Sun's, so that a white sheet has the light 1.
fn reflected(s: Surface, to_light: vec3f) -> vec3f {
    let n_l = dot(s.normal, to_light);
    if n_l <= 0.0 {
        return vec3f(0.0);
    }
    let h = normalize(to_light + s.to_eye);
    let n_v = max(dot(s.normal, s.to_eye), 1e-4);
    let n_h = saturate(dot(s.normal, h));
    let v_h = saturate(dot(s.to_eye, h));
    let a2 = s.alpha * s.alpha;
    // D = α²/(π((N·H)²(α² − 1) + 1)²), with 1 − (N·H)² as a cross product, which avoids cancellation.
    let across = cross(s.normal, h);
    let below = n_h * n_h * a2 + dot(across, across);
    let d = a2 / max(PI * below * below, 1e-12);
    // V = 0.5/(N·L √((N·V)²(1 − α²) + α²) + N·V √((N·L)²(1 − α²) + α²)).
    let v = 0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
    let f = s.f0 + (1.0 - s.f0) * pow(1.0 - v_h, 5.0);
    return ((1.0 - f) * s.diffuse + PI * d * v * f) * n_l;
}

// Cosine-weighted fraction of a sheet's hemisphere that a sphere fills: Cunningham 1961, NASA TN D-710. `c` is the cosine between the sheet's
// normal and the sphere's centre, `limb_sine` R/r. `tilted_view_factor` in crates/terrella-play/src/model_layer/earth_light.rs.
fn tilted_view_factor(c: f32, limb_sine: f32) -> f32 {
    let limb_cosine = sqrt(max(1.0 - limb_sine * limb_sine, 0.0));
    let k = limb_sine * limb_sine;
    // The whole disc is in front of the sheet, or behind it.
    if c >= limb_sine {
        return c * k;
    }
    if c <= -limb_sine {
        return 0.0;
    }
    let s = sqrt(max(1.0 - c * c, 1e-12));
    // With h = r/R: √(h² − 1) cot θ = limb_cosine c/(limb_sine s), √(h² − 1)/(h sin θ) = limb_cosine/s, and
    // √(1 − h² c²)/h² · √(h² − 1) = limb_cosine √(limb_sine² − c²).
    let turned = acos(clamp(-limb_cosine * c / max(limb_sine * s, 1e-6), -1.0, 1.0));
    let cut = asin(clamp(limb_cosine / s, -1.0, 1.0));
    let edge = limb_cosine * sqrt(max(k - c * c, 0.0));
    return max(0.5 - cut / PI + (k * c * turned - edge) / PI, 0.0);
}

// Directional albedo of the specular part, by an approximation of Karis 2014, "Physically Based Shading on Mobile".
fn directional_albedo(f0: vec3f, roughness: f32, n_v: f32) -> vec3f {
    let r = roughness * vec4f(-1.0, -0.0275, -0.572, 0.022) + vec4f(1.0, 0.0425, 1.04, -0.04);
    let a004 = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    return f0 * (-1.04 * a004 + r.z) + 1.04 * a004 + r.w;
}

// Light of the Earth's disc, assumed uniform: the diffuse part is exact; in the specular reflection the limb is as soft as the surface is rough.
fn earthshine(s: Surface, roughness: f32) -> vec3f {
    let seen = tilted_view_factor(dot(s.normal, craft.down), craft.limb_sine);
    let mirrored = reflect(-s.to_eye, s.normal);
    let limb_cosine = sqrt(max(1.0 - craft.limb_sine * craft.limb_sine, 0.0));
    let soft = max(s.alpha, 0.01);
    let in_mirror = smoothstep(-soft, soft, dot(mirrored, craft.down) - limb_cosine);
    let n_v = saturate(dot(s.normal, s.to_eye));
    return craft.earth_light * (s.diffuse * seen + directional_albedo(s.f0, roughness, n_v) * in_mirror);
}

@fragment
fn fragment(in: Varying, @builtin(front_facing) is_front: bool) -> @location(0) vec4f {
    let base = material.base_color * textureSample(base_color_texture, base_color_sampler, in.uv);
    let surface = textureSample(surface_texture, surface_sampler, in.uv);
    var normal = normalize(in.normal);
    @if(normal_map) normal = mapped_normal(in, normal);
    let own = material.emissive * textureSample(emissive_texture, emissive_sampler, in.uv).rgb;
    if base.a < material.alpha_cutoff {
        discard;
    }
    let metallic = material.metallic * surface.b;
    let roughness = material.roughness * surface.g;
    var s: Surface;
    // Of a sheet that is seen from both sides the side that is seen is the one that is lit.
    s.normal = select(-normal, normal, is_front);
    s.to_eye = normalize(craft.eye - in.position_m);
    s.diffuse = base.rgb * (1.0 - metallic);
    s.f0 = mix(vec3f(0.04), base.rgb, metallic);
    // A lower limit of the roughness: that of the image of the Sun's disc, 0.00465 rad.
    s.alpha = max(roughness * roughness, 0.005);
    var light = own + earthshine(s, roughness);
    light += craft.sunlight * reflected(s, craft.sun);
    light += craft.moonlight * reflected(s, craft.moon);
    let shown = displayed(light, craft.exposure, in.clip.xy);
    // What covers a part of a pixel is premultiplied.
    @if(blended) return vec4f(shown * base.a, base.a);
    @if(!blended) return vec4f(shown, 1.0);
}
