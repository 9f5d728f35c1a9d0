//! Content of a simulation's messages that is not drawn: its names in scripts, and which of Vizard's settings request it.

use super::wire::{Field, Value};

/// Parts of messages and settings that are not drawn, as a set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Undrawn(u128);

/// A part of a message. Its number is its bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum MessagePart {
    QuadMaps,
    Dialogs,
    ReactionWheels,
    Thrusters,
    SunSensors,
    GenericSensors,
    Sprites,
    Transceivers,
    Storage,
    Lights,
    Logos,
    MultiShapes,
    Ellipsoids,
    CraftModels,
    LocationFields,
    TargetLines,
    TooMany,
    RelativeOrbitChief,
    PlaybackPaused,
    PlaybackInRealTime,
    PlaybackMultiplier,
    DepthOfField,
    CameraHud,
    CameraSkyBox,
    UnknownSetting,
}

/// Their names, by their bit.
const PARTS: [&str; 25] = [
    "maps on the ground (quadMaps)",
    "dialogs (vizEventDialogs)",
    "reaction wheels",
    "thrusters",
    "coarse sun sensors",
    "generic sensors",
    "sprites of spacecraft",
    "transceivers",
    "storage devices",
    "lights of spacecraft",
    "logos of spacecraft",
    "shapes of spacecraft (multiShapes)",
    "ellipsoids about spacecraft",
    "spacecraft models by key",
    "fields of view of ground locations",
    "lines to targets",
    "more parts than a message may have",
    "liveSettings.relativeOrbitChief",
    "liveSettings.playbackPaused",
    "liveSettings.playbackInRealTime",
    "liveSettings.playbackMultiplier",
    "depth of field of cameras (postProcessingOn)",
    "showHUDElementsInImage of cameras",
    "a skyBox of cameras other than black",
    "settings that this version does not know",
];

/// Number of the setting for the sky.
pub const SKYBOX: u32 = 11;
/// The bit of setting number 1; parts are below.
const FIRST_SETTING_BIT: u32 = 63;

/// Condition under which a setting requests something that is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Asks {
    /// Where it is above zero: below it is off or the viewer's own choice, and nothing of the kind is drawn anyway.
    Above,
    /// If it is not zero, as the scene decides what is drawn of this kind.
    NotZero,
    /// If it is neither 0 nor 1.
    NotOne,
    /// If it has any value.
    There,
}

/// Settings (`VizSettingsPb`) by their number in the messages, as `viz.settings` spells them. Those that are followed are not here:
/// `keyboardLiveInput` (52), and [`SKYBOX`] where it is black.
const SETTINGS: [(u32, &str, Asks); 64] = [
    (1, "ambient", Asks::Above),
    (2, "orbitLinesOn", Asks::NotZero),
    (3, "spacecraftCSon", Asks::Above),
    (4, "planetCSon", Asks::Above),
    (5, "pointLineList", Asks::There),
    (6, "coneList", Asks::There),
    (7, "stdCameraList", Asks::There),
    (8, "viewCameraViewHUD", Asks::Above),
    (9, "instrumentGuiSettingsList", Asks::There),
    (10, "actuatorGuiSettingsList", Asks::There),
    (11, "a skyBox other than black", Asks::There),
    (12, "customModelList", Asks::There),
    (13, "viewCameraBoresightHUD", Asks::Above),
    (14, "viewCameraFrustumHUD", Asks::Above),
    (15, "showCSLabels", Asks::Above),
    (16, "showCelestialBodyLabels", Asks::Above),
    (17, "showSpacecraftLabels", Asks::NotZero),
    (18, "showCameraLabels", Asks::Above),
    (19, "customGUIReferenceHeight", Asks::Above),
    (20, "defaultSpacecraftSprite", Asks::There),
    (21, "showSpacecraftAsSprites", Asks::Above),
    (22, "showCelestialBodiesAsSprites", Asks::Above),
    (23, "show24hrClock", Asks::Above),
    (24, "showDataRateDisplay", Asks::Above),
    (25, "keyboardAngularRate", Asks::Above),
    (26, "keyboardZoomRate", Asks::Above),
    (27, "defaultThrusterColor", Asks::There),
    (28, "defaultThrusterPlumeLifeScalar", Asks::NotOne),
    (29, "orbitLineSegments", Asks::Above),
    (30, "relativeOrbitRange", Asks::Above),
    (31, "showHillFrame", Asks::Above),
    (32, "showVelocityFrame", Asks::Above),
    (33, "relativeOrbitFrame", Asks::Above),
    (34, "mainCameraTarget", Asks::There),
    (35, "spacecraftShadowBrightness", Asks::Above),
    (36, "spacecraftSizeMultiplier", Asks::Above),
    (37, "showLocationCommLines", Asks::Above),
    (38, "showLocationCones", Asks::Above),
    (39, "showLocationLabels", Asks::NotZero),
    (40, "trueTrajectoryLinesOn", Asks::NotZero),
    (41, "atmospheresOff", Asks::Above),
    (42, "scViewToPlanetViewBoundaryMultiplier", Asks::Above),
    (43, "planetViewToHelioViewBoundaryMultiplier", Asks::Above),
    (44, "sunIntensity", Asks::Above),
    (45, "attenuateSunLightWithDistance", Asks::Above),
    (46, "showLightLabels", Asks::Above),
    (47, "celestialBodyHelioViewSizeMultiplier", Asks::Above),
    (48, "showMissionTime", Asks::Above),
    (49, "spacecraftHelioViewSizeMultiplier", Asks::Above),
    (50, "forceStartAtSpacecraftLocalView", Asks::Above),
    (51, "useSimpleLocationMarkers", Asks::NotZero),
    (53, "messageBufferSize", Asks::NotZero),
    (54, "truePathRelativeBody", Asks::There),
    (55, "truePathRotatingFrame", Asks::There),
    (56, "truePathFixedFrame", Asks::There),
    (57, "showQuadMapLabels", Asks::Above),
    (58, "spacecraftOrbitLineWidth", Asks::Above),
    (59, "celestialBodyOrbitLineWidth", Asks::Above),
    (60, "linesAndFramesLineWidth", Asks::Above),
    (61, "useLineRenderersForTargetLinesAndFrames", Asks::Above),
    (62, "showOsculatingGroundTrackLines", Asks::NotZero),
    (63, "osculatingOrbitLineRange", Asks::There),
    (64, "osculatingGroundTrackRange", Asks::There),
    (65, "showTruePathGroundTrackLines", Asks::NotZero),
];

impl Asks {
    fn is_met_by(self, value: Value<'_>) -> bool {
        // Bytes are texts, lists and messages, whatever is expected: their presence is a request.
        let number = match value {
            Value::Bytes(bytes) => return !bytes.is_empty(),
            Value::Varint(whole) => whole.cast_signed() as f64,
            Value::Fixed64(bytes) => f64::from_le_bytes(bytes),
            Value::Fixed32 => return true,
        };
        match self {
            Self::Above => number > 0.0,
            Self::NotZero | Self::There => number != 0.0,
            Self::NotOne => number != 0.0 && number != 1.0,
        }
    }
}

impl Undrawn {
    /// Adds a part of a message.
    pub(super) fn add(&mut self, part: MessagePart) {
        self.0 |= 1 << part as u8;
    }

    /// Adds a setting that requests something that is not drawn.
    pub(super) fn add_setting(&mut self, field: &Field<'_>) {
        match SETTINGS.binary_search_by_key(&field.number, |(number, ..)| *number) {
            Ok(at) => {
                let (number, _, asks) = SETTINGS[at];
                if asks.is_met_by(field.value) {
                    self.0 |= 1 << (FIRST_SETTING_BIT + number - 1);
                }
            }
            Err(_) => self.add(MessagePart::UnknownSetting),
        }
    }

    /// The names in this set that are not in the other.
    pub fn names_beyond(self, known: Self) -> impl Iterator<Item = &'static str> {
        let new = self.0 & !known.0;
        let has = move |bit: u32| new & (1 << bit) != 0;
        let parts = PARTS.iter().zip(0..);
        let parts = parts.filter(move |(_, bit)| has(*bit));
        let settings = SETTINGS.iter();
        let settings = settings.filter(move |(number, ..)| has(FIRST_SETTING_BIT + *number - 1));
        parts
            .map(|(name, _)| *name)
            .chain(settings.map(|(_, name, _)| *name))
    }

    /// Adds all of another set.
    pub fn join(&mut self, other: Self) {
        self.0 |= other.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_part_and_each_setting_has_a_bit_and_a_name_of_its_own() {
        let last = MessagePart::UnknownSetting as usize;
        assert_eq!(last + 1, PARTS.len());
        assert!(last < FIRST_SETTING_BIT as usize);
        assert!(SETTINGS.is_sorted_by_key(|(number, ..)| *number));
        let mut names: Vec<_> = Undrawn(u128::MAX)
            .names_beyond(Undrawn::default())
            .collect();
        assert_eq!(names.len(), PARTS.len() + SETTINGS.len());
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), PARTS.len() + SETTINGS.len());
        let (last, ..) = SETTINGS[SETTINGS.len() - 1];
        assert!(FIRST_SETTING_BIT + last - 1 < u128::BITS);
    }
}
