// A flat tree: no maps, no air, each face in one grey by its slope.

struct View { clip_from_eye: mat4x4f, eye_from_middle: vec4f }
@group(0) @binding(0) var<uniform> view: View;
struct Corner { @builtin(position) at: vec4f, @location(0) from_eye: vec3f }
@vertex fn vertex(@location(0) from_middle: vec3f) -> Corner {
    let from_eye = from_middle - view.eye_from_middle.xyz;
    return Corner(view.clip_from_eye * vec4f(from_eye, 1.0), from_eye);
}
@fragment fn fragment(corner: Corner) -> @location(0) vec4f {
    let normal = normalize(cross(dpdx(corner.from_eye), dpdy(corner.from_eye)));
    // Light from the west, 40 degrees high; faces look up whichever way the axes of the screen turn.
    let up = select(-normal, normal, normal.z > 0.0);
    let light = max(dot(up, vec3f(-0.66, 0.38, 0.64)), 0.0);
    return vec4f(vec3f(0.05 + 0.8 * light), 1.0);
}
