//! Basilisk's messages (`vizMessage.proto` of Basilisk 2.12): what of them is drawn, as plain values, with limits.
//!
//! Lengths in the messages are metres, gravity parameters and radii of bodies aside, which are not used. Repeated numbers that
//! are fewer than they should be are taken as absent, as proto3 leaves out what is zero.

use super::undrawn::{MessagePart, SKYBOX, Undrawn};
use super::wire::{Field, Fields, Numbers, Value, Wholes, WireFault, put_varint};
use glam::{DMat3, DVec3};

/// Most bytes of one message.
pub const MAX_MESSAGE_BYTES: usize = 16 << 20;
/// Most celestial bodies that are read of one message.
pub const MAX_BODIES: usize = 64;
/// Most spacecraft.
pub const MAX_CRAFT: usize = 1000;
/// Most cameras.
pub const MAX_CAMERAS: usize = 64;
/// Most ground locations.
pub const MAX_LOCATIONS: usize = 1000;
/// Most characters of a name.
pub const MAX_NAME_CHARS: usize = 128;

/// One message: a step of the simulation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Message {
    /// Count of the message, from 1; skipped steps count.
    pub frame_number: i64,
    /// Simulated time since the epoch, nanoseconds.
    pub elapsed_ns: f64,
    /// Planets, moons and the Sun.
    pub bodies: Vec<Body>,
    /// Spacecraft.
    pub craft: Vec<Craft>,
    /// Cameras whose images the simulation requests.
    pub cameras: Vec<Camera>,
    /// When simulated time is 0, UTC; only where it is new.
    pub epoch: Option<EpochDate>,
    /// Places on the ground that are new or changed.
    pub locations: Vec<Location>,
    /// The simulation requests the viewer to close.
    pub ends_viewer: bool,
    /// Characters whose keys the script listens to; only where settings come.
    pub live_keys: Option<String>,
    /// The sky of the window, a keyword or a path; only in messages with settings.
    pub skybox: Option<String>,
    /// Content that is not drawn.
    pub undrawn: Undrawn,
}

/// A planet, a moon or the Sun.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Body {
    /// Lower case: `earth`, `sun`, `mars barycenter` ….
    pub name: String,
    /// Metres from the simulation's origin, J2000 axes.
    pub position_m: DVec3,
    /// Metres a second.
    pub velocity_m_s: DVec3,
    /// Rotation from inertial axes to those fixed in the body; `None` if absent.
    pub fixed_from_inertial: Option<DMat3>,
}

/// A spacecraft.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Craft {
    /// Its `ModelTag`.
    pub name: String,
    /// Metres from the simulation's origin, J2000 axes.
    pub position_m: DVec3,
    /// Metres a second.
    pub velocity_m_s: DVec3,
    /// Attitude of the body against inertial axes, σ_BN: modified Rodrigues parameters.
    pub mrp_bn: DVec3,
}

/// A camera.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Camera {
    /// Its number, which requests for pictures name.
    pub id: i64,
    /// The spacecraft that it is fixed to.
    pub parent: String,
    /// Vertical field of view, edge to edge, degrees.
    pub fov_deg: f64,
    /// Width and height, pixels; `None` if not given.
    pub size: Option<[i64; 2]>,
    /// Its place on the craft, metres, body axes.
    pub position_b_m: DVec3,
    /// Its attitude as in the message (`cameraDir_B`): modified Rodrigues parameters.
    pub mrp: DVec3,
    /// Whether the request is for a depth map instead of an image.
    pub is_depth: bool,
    /// Distances at which depth begins and ends, metres.
    pub clip_m: Option<[f64; 2]>,
    /// Focal length, millimetres (`ppFocalLength`); `None` if not given.
    pub focal_length_mm: Option<f64>,
    /// F-number (`ppAperture`); likewise.
    pub f_number: Option<f64>,
    /// The background: a keyword or a path.
    pub skybox: String,
}

impl Camera {
    /// Whether its images have no stars: by its own sky if set, otherwise by that of the settings.
    pub fn is_sky_black(&self, of_settings: bool) -> bool {
        match self.skybox.is_empty() {
            true => of_settings,
            false => is_black(&self.skybox),
        }
    }
}

/// A place on the ground.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Location {
    /// Its name; a later one of the same name takes its place.
    pub name: String,
    /// Its label, if that differs.
    pub label: String,
    /// The body that it is on.
    pub body: String,
    /// Metres from the body's centre, axes fixed in it.
    pub position_fixed_m: DVec3,
    /// The vertical there, in body-fixed axes; zero if absent.
    pub up: DVec3,
    /// Red, green, blue.
    pub color: Option<[u8; 3]>,
    /// Whether it is hidden.
    pub is_hidden: bool,
}

/// When simulated time is 0, UTC.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EpochDate {
    /// Year.
    pub year: i64,
    /// 1…12.
    pub month: i64,
    /// From 1.
    pub day: i64,
    /// 0…23.
    pub hour: i64,
    /// 0…59.
    pub minute: i64,
    /// 0…60, with decimals.
    pub second: f64,
}

/// Adds one to a list, unless that has as many as it may.
fn push<T>(list: &mut Vec<T>, most: usize, one: T, undrawn: &mut Undrawn) {
    match list.len() < most {
        true => list.push(one),
        false => undrawn.add(MessagePart::TooMany),
    }
}

impl Message {
    /// Reads a message.
    ///
    /// # Errors
    /// Bytes that are no such message.
    pub fn read(bytes: &[u8]) -> Result<Self, WireFault> {
        let mut message = Self::default();
        let mut undrawn = Undrawn::default();
        for field in Fields::of(bytes) {
            let field = field?;
            match field.number {
                1 => (message.frame_number, message.elapsed_ns) = time_stamp(field.bytes()?)?,
                2 => {
                    let body = body(field.bytes()?)?;
                    push(&mut message.bodies, MAX_BODIES, body, &mut undrawn);
                }
                3 => {
                    let craft = craft(field.bytes()?, &mut undrawn)?;
                    push(&mut message.craft, MAX_CRAFT, craft, &mut undrawn);
                }
                4 => {
                    let camera = camera(field.bytes()?, &mut undrawn)?;
                    push(&mut message.cameras, MAX_CAMERAS, camera, &mut undrawn);
                }
                5 => undrawn.add(MessagePart::QuadMaps),
                7 => {
                    let (keys, skybox) = settings(field.bytes()?, &mut undrawn)?;
                    (message.live_keys, message.skybox) = (Some(keys), Some(skybox));
                }
                8 => message.epoch = Some(epoch(field.bytes()?)?),
                9 => {
                    let location = location(field.bytes()?, &mut undrawn)?;
                    push(
                        &mut message.locations,
                        MAX_LOCATIONS,
                        location,
                        &mut undrawn,
                    );
                }
                10 => message.ends_viewer = live_settings(field.bytes()?, &mut undrawn)?,
                11 => undrawn.add(MessagePart::Dialogs),
                _ => {}
            }
        }
        message.undrawn = undrawn;
        Ok(message)
    }
}

/// Frame number, and simulated nanoseconds since the epoch.
pub fn time_stamp(bytes: &[u8]) -> Result<(i64, f64), WireFault> {
    let (mut number, mut elapsed_ns) = (0, 0.0);
    for field in Fields::of(bytes) {
        let field = field?;
        match field.number {
            1 => number = field.whole()?,
            2 => elapsed_ns = field.number()?,
            _ => {}
        }
    }
    Ok((number, elapsed_ns))
}

pub fn epoch(bytes: &[u8]) -> Result<EpochDate, WireFault> {
    let mut date = EpochDate::default();
    for field in Fields::of(bytes) {
        let field = field?;
        match field.number {
            1 => date.year = field.whole()?,
            2 => date.month = field.whole()?,
            3 => date.day = field.whole()?,
            4 => date.hour = field.whole()?,
            5 => date.minute = field.whole()?,
            6 => date.second = field.number()?,
            _ => {}
        }
    }
    Ok(date)
}

fn vector(numbers: Numbers<3>) -> DVec3 {
    numbers.all().copied().map_or(DVec3::ZERO, DVec3::from)
}

fn body(bytes: &[u8]) -> Result<Body, WireFault> {
    let mut body = Body::default();
    let (mut position, mut velocity) = (Numbers::default(), Numbers::default());
    let mut rotation = Numbers::<9>::default();
    for field in Fields::of(bytes) {
        let field = field?;
        match field.number {
            1 => body.name = field.text(MAX_NAME_CHARS)?.trim().to_lowercase(),
            2 => position.add(&field)?,
            3 => velocity.add(&field)?,
            4 => rotation.add(&field)?,
            _ => {}
        }
    }
    body.position_m = vector(position);
    body.velocity_m_s = vector(velocity);
    // Row by row.
    body.fixed_from_inertial = rotation
        .all()
        .map(|rows| DMat3::from_cols_array(rows).transpose());
    Ok(body)
}

fn craft(bytes: &[u8], undrawn: &mut Undrawn) -> Result<Craft, WireFault> {
    let mut craft = Craft::default();
    let (mut position, mut velocity) = (Numbers::default(), Numbers::default());
    let mut mrp = Numbers::default();
    for field in Fields::of(bytes) {
        let field = field?;
        let is_there = !matches!(field.value, Value::Bytes([]));
        match field.number {
            1 => craft.name = field.text(MAX_NAME_CHARS)?,
            2 => position.add(&field)?,
            3 => velocity.add(&field)?,
            4 => mrp.add(&field)?,
            5 => undrawn.add(MessagePart::ReactionWheels),
            6 => undrawn.add(MessagePart::Thrusters),
            7 => undrawn.add(MessagePart::SunSensors),
            8 => undrawn.add(MessagePart::GenericSensors),
            9 if is_there => undrawn.add(MessagePart::Sprites),
            10 => undrawn.add(MessagePart::Transceivers),
            11 => undrawn.add(MessagePart::Storage),
            12 => undrawn.add(MessagePart::Lights),
            16 if is_there => undrawn.add(MessagePart::Logos),
            17 => undrawn.add(MessagePart::MultiShapes),
            18 => undrawn.add(MessagePart::Ellipsoids),
            13 if is_there => undrawn.add(MessagePart::CraftModels),
            _ => {}
        }
    }
    craft.position_m = vector(position);
    craft.velocity_m_s = vector(velocity);
    craft.mrp_bn = vector(mrp);
    Ok(craft)
}

fn camera(bytes: &[u8], undrawn: &mut Undrawn) -> Result<Camera, WireFault> {
    let mut camera = Camera::default();
    let mut size = Wholes::<2>::default();
    let (mut position, mut mrp) = (Numbers::default(), Numbers::default());
    let mut clip = Numbers::<2>::default();
    for field in Fields::of(bytes) {
        let field = field?;
        match field.number {
            1 => camera.id = field.whole()?,
            2 => camera.parent = field.text(MAX_NAME_CHARS)?,
            3 => camera.fov_deg = field.number()?,
            4 => size.add(&field)?,
            7 => position.add(&field)?,
            8 => mrp.add(&field)?,
            10 => {
                camera.skybox = field.text(MAX_NAME_CHARS)?;
                if !camera.skybox.is_empty() && !is_black(&camera.skybox) {
                    undrawn.add(MessagePart::CameraSkyBox);
                }
            }
            11 if field.whole()? > 0 => undrawn.add(MessagePart::DepthOfField),
            // Absent is zero.
            13 => camera.f_number = Some(field.number()?).filter(|f_number| *f_number != 0.0),
            14 => camera.focal_length_mm = Some(field.number()?).filter(|mm| *mm != 0.0),
            18 if field.whole()? > 0 => undrawn.add(MessagePart::CameraHud),
            16 => camera.is_depth = field.whole()? == 1,
            17 => clip.add(&field)?,
            _ => {}
        }
    }
    camera.size = size.all().copied();
    camera.position_b_m = vector(position);
    camera.mrp = vector(mrp);
    camera.clip_m = clip.all().copied();
    Ok(camera)
}

fn location(bytes: &[u8], undrawn: &mut Undrawn) -> Result<Location, WireFault> {
    let place = read_location(bytes)?;
    if Fields::of(bytes).flatten().any(|field| {
        let above_zero = |field: &Field<'_>| field.number().is_ok_and(|value| value > 0.0);
        matches!(field.number, 5 | 7) && above_zero(&field)
    }) {
        undrawn.add(MessagePart::LocationFields);
    }
    Ok(place)
}

/// A place on the ground.
pub fn read_location(bytes: &[u8]) -> Result<Location, WireFault> {
    let mut place = Location::default();
    let (mut position, mut up) = (Numbers::default(), Numbers::default());
    let mut color = Wholes::<4>::default();
    for field in Fields::of(bytes) {
        let field = field?;
        match field.number {
            1 => place.name = field.text(MAX_NAME_CHARS)?,
            2 => place.body = field.text(MAX_NAME_CHARS)?.trim().to_lowercase(),
            3 => position.add(&field)?,
            4 => up.add(&field)?,
            6 => color.add(&field)?,
            9 => place.is_hidden = field.is_true()?,
            10 => place.label = field.text(MAX_NAME_CHARS)?,
            _ => {}
        }
    }
    place.position_fixed_m = vector(position);
    place.up = vector(up);
    // A default is written as −1, 0, 0, 0.
    let color = color.all().and_then(|[red, green, blue, _]| {
        let part = |value: &i64| u8::try_from(*value).ok();
        Some([part(red)?, part(green)?, part(blue)?])
    });
    place.color = color;
    Ok(place)
}

/// Whether the viewer is requested to close.
fn live_settings(bytes: &[u8], undrawn: &mut Undrawn) -> Result<bool, WireFault> {
    let mut ends = false;
    for field in Fields::of(bytes) {
        let field = field?;
        match field.number {
            1 => undrawn.add(MessagePart::TargetLines),
            2 if !matches!(field.value, Value::Bytes([])) => {
                undrawn.add(MessagePart::RelativeOrbitChief)
            }
            4 if field.is_true()? => undrawn.add(MessagePart::PlaybackPaused),
            5 if field.whole()? > 0 => undrawn.add(MessagePart::PlaybackInRealTime),
            6 if field.whole()? > 1 => undrawn.add(MessagePart::PlaybackMultiplier),
            3 => ends = field.is_true()?,
            _ => {}
        }
    }
    Ok(ends)
}

/// The keys that a script listens to, and the sky, from its settings; everything else in them is not drawn.
fn settings(bytes: &[u8], undrawn: &mut Undrawn) -> Result<(String, String), WireFault> {
    let (mut keys, mut skybox) = (String::new(), String::new());
    for field in Fields::of(bytes) {
        let field = field?;
        match field.number {
            SKYBOX => {
                skybox = field.text(MAX_NAME_CHARS)?;
                if !is_black(&skybox) {
                    undrawn.add_setting(&field);
                }
            }
            52 => keys = field.text(MAX_NAME_CHARS)?,
            _ => undrawn.add_setting(&field),
        }
    }
    Ok((keys, skybox))
}

/// Whether a sky has no stars.
pub fn is_black(skybox: &str) -> bool {
    skybox.trim().eq_ignore_ascii_case("black")
}

/// The viewer's reply to a request for input: its current frame, and the pressed keys.
pub fn viewer_input(frame_number: i64, keys: &str) -> Vec<u8> {
    let mut bytes = vec![0x08];
    put_varint(&mut bytes, frame_number.cast_unsigned());
    if !keys.is_empty() {
        // keyInputs, a message of one string.
        let mut inner = vec![0x0a];
        put_varint(&mut inner, keys.len() as u64);
        inner.extend_from_slice(keys.as_bytes());
        bytes.push(0x12);
        put_varint(&mut bytes, inner.len() as u64);
        bytes.extend(inner);
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A field of bytes shorter than 128.
    fn field(number: u8, bytes: &[u8]) -> Vec<u8> {
        [&[number << 3 | 2, bytes.len() as u8], bytes].concat()
    }

    fn of_settings(settings: &[u8]) -> Message {
        Message::read(&field(7, settings)).expect("a message")
    }

    #[test]
    fn a_black_sky_is_followed_and_another_one_is_named() {
        let names = |message: &Message| {
            let names = message.undrawn.names_beyond(Undrawn::default());
            names.collect::<Vec<_>>()
        };
        let black = of_settings(&field(11, b"black"));
        assert!(black.skybox.as_deref().is_some_and(is_black));
        assert_eq!(names(&black), [""; 0]);
        let other = of_settings(&field(11, b"NASA_SVS"));
        assert!(!other.skybox.as_deref().is_some_and(is_black));
        assert_eq!(names(&other), ["a skyBox other than black"]);
        // Two settings that are not drawn: ambient (1, a double) and showHillFrame (31, a whole number).
        let ambient = [&[1 << 3 | 1][..], &0.5_f64.to_le_bytes()].concat();
        let two = of_settings(&[ambient, vec![0xf8, 0x01, 1]].concat());
        assert_eq!(names(&two), ["ambient", "showHillFrame"]);
        let camera = Message::read(&field(4, &field(10, b"black"))).expect("a message");
        assert!(camera.cameras[0].is_sky_black(false) && names(&camera).is_empty());
        let none = Message::read(&field(4, &[])).expect("a message");
        assert!(none.cameras[0].is_sky_black(true) && !none.cameras[0].is_sky_black(false));
    }
}
