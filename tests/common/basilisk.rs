//! Messages as Basilisk writes them, for tests: a small writer of Protocol Buffers.

#![allow(dead_code, reason = "each program of tests takes what it needs")]

/// A variable-length number.
pub fn varint(mut value: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
    bytes
}

/// A field that is bytes: text, a message, packed numbers.
pub fn bytes(number: u64, body: &[u8]) -> Vec<u8> {
    [
        varint(number << 3 | 2),
        varint(body.len() as u64),
        body.to_vec(),
    ]
    .concat()
}

/// A field that is a whole number.
pub fn whole(number: u64, value: u64) -> Vec<u8> {
    [varint(number << 3), varint(value)].concat()
}

/// A field that is a number.
pub fn number(number: u64, value: f64) -> Vec<u8> {
    [varint(number << 3 | 1), value.to_le_bytes().to_vec()].concat()
}

/// A field of numbers, packed.
pub fn numbers(number: u64, values: &[f64]) -> Vec<u8> {
    let packed: Vec<u8> = values
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    bytes(number, &packed)
}

/// The Earth at a place, turned by an angle.
pub fn earth(position_m: [f64; 3], velocity_m_s: [f64; 3], theta_rad: f64) -> Vec<u8> {
    let (s, c) = theta_rad.sin_cos();
    let body = [
        bytes(1, b"earth"),
        numbers(2, &position_m),
        numbers(3, &velocity_m_s),
        numbers(4, &[c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0]),
        number(6, 6378.1366),
    ];
    bytes(2, &body.concat())
}

/// Another body.
pub fn body(name: &str, position_m: [f64; 3]) -> Vec<u8> {
    let body = [bytes(1, name.as_bytes()), numbers(2, &position_m)];
    bytes(2, &body.concat())
}

/// A spacecraft.
pub fn craft(name: &str, position_m: [f64; 3], velocity_m_s: [f64; 3], mrp: [f64; 3]) -> Vec<u8> {
    let craft = [
        bytes(1, name.as_bytes()),
        numbers(2, &position_m),
        numbers(3, &velocity_m_s),
        numbers(4, &mrp),
    ];
    bytes(3, &craft.concat())
}

/// A camera that looks along +z of the body, +x to the right.
pub fn camera(id: u64, parent: &str, fov_deg: f64, size: [u64; 2], mode: u64) -> Vec<u8> {
    camera_with(id, parent, fov_deg, size, &whole(16, mode))
}

/// The same with further fields.
pub fn camera_with(
    id: u64,
    parent: &str,
    fov_deg: f64,
    [width, height]: [u64; 2],
    further: &[u8],
) -> Vec<u8> {
    let third = 1.0 / 3.0;
    let camera = [
        whole(1, id),
        bytes(2, parent.as_bytes()),
        number(3, fov_deg),
        bytes(4, &[varint(width), varint(height)].concat()),
        numbers(8, &[third, third, -third]),
        further.to_vec(),
        numbers(17, &[1e3, 1e8]),
    ];
    bytes(4, &camera.concat())
}

/// A place on the Earth.
pub fn location(name: &str, position_m: [f64; 3]) -> Vec<u8> {
    let location = [
        bytes(1, name.as_bytes()),
        bytes(2, b"earth"),
        numbers(3, &position_m),
        bytes(
            6,
            &[varint(255), varint(255), varint(0), varint(255)].concat(),
        ),
    ];
    bytes(9, &location.concat())
}

/// 2026-03-20T14:46:00Z.
pub fn epoch() -> Vec<u8> {
    let parts = [
        whole(1, 2026),
        whole(2, 3),
        whole(3, 20),
        whole(4, 14),
        whole(5, 46),
    ];
    bytes(8, &parts.concat())
}

/// A message of these parts.
pub fn message(frame: u64, elapsed_s: f64, parts: &[Vec<u8>]) -> Vec<u8> {
    let time = [whole(1, frame), number(2, elapsed_s * 1e9)].concat();
    [bytes(1, &time), parts.concat()].concat()
}

pub fn file(messages: &[Vec<u8>]) -> Vec<u8> {
    let framed = messages
        .iter()
        .map(|message| [varint(message.len() as u64), message.clone()].concat());
    framed.collect::<Vec<_>>().concat()
}

/// A satellite on a circle of 7000 km about an Earth far from the origin, after so many seconds, with its epoch in the first message.
pub fn step(frame: u64, elapsed_s: f64) -> Vec<u8> {
    let (angle, radius_m, rate) = (elapsed_s * 0.001, 7e6, 0.001);
    let (s, c) = angle.sin_cos();
    let (x, y, z) = (1.5e11, 2e10, -3e9);
    let mut parts = vec![
        earth([x, y, z], [29_000.0, 0.0, 0.0], 7.292e-5 * elapsed_s + 0.5),
        body("sun", [x - 1.4e11, y + 4e10, z]),
        craft(
            "sat-1",
            [x + radius_m * c, y + radius_m * s, z],
            [29_000.0 - radius_m * rate * s, radius_m * rate * c, 0.0],
            [0.0, 0.0, (angle / 4.0).tan()],
        ),
        craft("sat-2", [x, y, z + 8e6], [29_000.0, 7e3, 0.0], [0.0; 3]),
        camera(1, "sat-1", 35.0, [96, 64], 0),
    ];
    if frame == 1 {
        parts.extend([epoch(), location("Boulder", [-1.3e6, -4.7e6, 4.1e6])]);
    }
    message(frame, elapsed_s, &parts)
}
