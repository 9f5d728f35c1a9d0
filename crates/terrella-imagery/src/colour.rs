//! Colour metadata of a file and its orientation: gamma, colour profiles, Exif.
//!
//! Colours are drawn as sRGB. Other colour spaces are not converted but reported.
//! Sources: PNG (W3C, third edition) 11.3.2, ICC.1:2022 (7.2, 8.3, 10.6, 10.18), Exif 2.32 (4.5.4).

/// Metadata of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Said {
    /// How its colours differ from sRGB, if they do.
    pub colours: Option<String>,
    /// Orientation of its texels: 1…8, 1 is upright.
    pub orientation: Option<u16>,
}

impl Said {
    /// How the texels are turned, if they are, in words that follow "is stored".
    pub fn turned(&self) -> Option<&'static str> {
        Some(match self.orientation? {
            2 => "mirrored",
            3 => "upside down",
            4 => "mirrored and upside down",
            5..=8 => "on its side",
            _ => return None,
        })
    }

    /// The note on its colours.
    pub fn note(&self) -> Option<String> {
        let colours = self.colours.as_ref()?;
        Some(format!(
            "has {colours}; it is drawn as if it were sRGB: convert it (`magick IN -profile sRGB.icc OUT`) for true colours"
        ))
    }

    /// Of a PNG, by the most exact of its chunks.
    pub fn of_png(info: &png::Info<'_>) -> Self {
        let exif = info.exif_metadata.as_deref();
        Self {
            colours: png_colours(info),
            orientation: exif.and_then(exif_orientation),
        }
    }

    /// From the Exif data and the colour profile of a JPEG or TIFF.
    pub fn of_parts(exif: Option<&[u8]>, profile: Option<&[u8]>) -> Self {
        Self {
            colours: profile.and_then(foreign_profile),
            orientation: exif.and_then(exif_orientation),
        }
    }
}

fn png_colours(info: &png::Info<'_>) -> Option<String> {
    if let Some(code) = &info.coding_independent_code_points {
        let (primaries, transfer) = (code.color_primaries, code.transfer_function);
        // BT.709 and sRGB (H.273, tables 2 and 3).
        return ((primaries, transfer) != (1, 13))
            .then(|| format!("colours of the code points {primaries} and {transfer}"));
    }
    if let Some(profile) = info.icc_profile.as_deref() {
        return foreign_profile(profile);
    }
    if info.srgb.is_some() {
        return None;
    }
    let gamma = info.gama_chunk.map(|gamma| gamma.into_value());
    // sRGB is near a gamma of 1 / 2.2.
    if let Some(gamma) = gamma.filter(|gamma| (gamma * 2.2 - 1.0).abs() > 0.05) {
        return Some(format!("a gamma of {gamma:.3} where sRGB has about 0.455"));
    }
    let chromaticities = info.chrm_chunk?;
    let far = |(x, y): (png::ScaledFloat, png::ScaledFloat), to: (f32, f32)| {
        (x.into_value() - to.0).abs() > 0.01 || (y.into_value() - to.1).abs() > 0.01
    };
    let is_foreign = far(chromaticities.red, (0.64, 0.33))
        || far(chromaticities.green, (0.30, 0.60))
        || far(chromaticities.blue, (0.15, 0.06))
        || far(chromaticities.white, (0.3127, 0.3290));
    is_foreign.then(|| "primaries other than those of sRGB".to_string())
}

/// The name of a colour profile that is not sRGB's, as text.
fn foreign_profile(profile: &[u8]) -> Option<String> {
    let tags = Tags(profile);
    let is_srgb = match profile.get(16..20) {
        Some(b"GRAY") => tags.is_near_srgb_curve(b"kTRC"),
        Some(b"RGB ") => {
            // Red, green and blue of sRGB as a display profile has them, adapted to D50.
            tags.is_near_colorant(b"rXYZ", [0.4361, 0.2225, 0.0139])
                && tags.is_near_colorant(b"gXYZ", [0.3851, 0.7169, 0.0971])
                && tags.is_near_colorant(b"bXYZ", [0.1431, 0.0606, 0.7141])
                && [b"rTRC", b"gTRC", b"bTRC"]
                    .iter()
                    .all(|name| tags.is_near_srgb_curve(name))
        }
        _ => false,
    };
    (!is_srgb).then(|| match tags.description() {
        Some(name) => format!("the colour profile {name:?}"),
        None => "a colour profile without a name".to_string(),
    })
}

/// Tags of a colour profile.
struct Tags<'a>(&'a [u8]);

impl<'a> Tags<'a> {
    /// The contents of a tag.
    fn find(&self, name: &[u8; 4]) -> Option<&'a [u8]> {
        let number =
            |at: usize| Some(u32::from_be_bytes(*self.0.get(at..)?.first_chunk()?) as usize);
        // A profile has some ten tags.
        let count = number(128)?.min(256);
        (0..count).find_map(|n| {
            let entry = 132 + 12 * n;
            let is_named = self.0.get(entry..entry + 4)? == name;
            let (start, length) = (number(entry + 4)?, number(entry + 8)?);
            is_named.then(|| self.0.get(start..start.checked_add(length)?))?
        })
    }

    fn is_near_colorant(&self, name: &[u8; 4], known: [f64; 3]) -> bool {
        let found = self.find(name).unwrap_or_default();
        (0..3).zip(known).all(|(n, known)| {
            fixed(found, 8 + 4 * n).is_some_and(|value| (value - known).abs() < 0.01)
        })
    }

    /// Whether a curve maps one half to nearly the same value as sRGB's.
    fn is_near_srgb_curve(&self, name: &[u8; 4]) -> bool {
        let half = self.find(name).and_then(light_of_half);
        half.is_some_and(|light| (light - 0.214).abs() < 0.01)
    }

    /// The profile's name, at most 60 characters.
    fn description(&self) -> Option<String> {
        let tag = self.find(b"desc")?;
        let number = |at: usize| Some(u32::from_be_bytes(*tag.get(at..)?.first_chunk()?) as usize);
        let text = match tag.first_chunk()? {
            b"mluc" => {
                let (length, start) = (number(20)?, number(24)?);
                let (units, _) = tag.get(start..start.checked_add(length)?)?.as_chunks::<2>();
                let units: Vec<u16> = units.iter().map(|unit| u16::from_be_bytes(*unit)).collect();
                String::from_utf16_lossy(&units)
            }
            b"desc" => {
                let length = number(8)?;
                String::from_utf8_lossy(tag.get(12..12_usize.checked_add(length)?)?).into_owned()
            }
            _ => return None,
        };
        let name: String = text.trim_matches(['\0', ' ']).chars().take(60).collect();
        (!name.is_empty()).then_some(name)
    }
}

/// An s15Fixed16Number.
fn fixed(bytes: &[u8], at: usize) -> Option<f64> {
    let bits = i32::from_be_bytes(*bytes.get(at..)?.first_chunk()?);
    Some(f64::from(bits) / 65_536.0)
}

/// The light, 0…1, that a curve gives one half.
fn light_of_half(curve: &[u8]) -> Option<f64> {
    let short = |at: usize| Some(u16::from_be_bytes(*curve.get(at..)?.first_chunk()?));
    match curve.first_chunk()? {
        b"curv" => {
            let count = u32::from_be_bytes(*curve.get(8..)?.first_chunk()?) as usize;
            match count {
                0 => Some(0.5),
                1 => Some(0.5_f64.powf(f64::from(short(12)?) / 256.0)),
                // The entry in the middle, of an even number the one after it.
                _ => Some(f64::from(short(12_usize.checked_add(count / 2 * 2)?)?) / 65_535.0),
            }
        }
        // Y = (a X + b)^g, plus c or e in some forms, where X is not below d.
        b"para" => {
            let number = |n: usize| fixed(curve, 12 + 4 * n);
            let (gamma, kind) = (number(0)?, short(8)?);
            let (a, b) = match kind {
                0 => (1.0, 0.0),
                _ => (number(1)?, number(2)?),
            };
            let added = match kind {
                2 => number(3)?,
                4 => number(5)?,
                _ => 0.0,
            };
            Some((a * 0.5 + b).powf(gamma) + added)
        }
        _ => None,
    }
}

/// The orientation in Exif data, which are a TIFF without a picture.
fn exif_orientation(exif: &[u8]) -> Option<u16> {
    const ORIENTATION: u16 = 274;
    let is_big = match exif.first_chunk()? {
        b"MM\0\x2a" => true,
        b"II\x2a\0" => false,
        _ => return None,
    };
    let short = |at: usize| {
        let bytes = *exif.get(at..)?.first_chunk()?;
        Some(if is_big {
            u16::from_be_bytes(bytes)
        } else {
            u16::from_le_bytes(bytes)
        })
    };
    let bytes = *exif.get(4..)?.first_chunk()?;
    let start = if is_big {
        u32::from_be_bytes(bytes)
    } else {
        u32::from_le_bytes(bytes)
    } as usize;
    let count = usize::from(short(start)?);
    (0..count).find_map(|n| {
        let entry = start.checked_add(2 + 12 * n)?;
        (short(entry)? == ORIENTATION).then(|| short(entry + 8))?
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A profile of these tags, with an empty header except for its colour space.
    fn profile(space: &[u8; 4], tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
        let mut bytes = vec![0; 128];
        bytes[16..20].copy_from_slice(space);
        bytes.extend((tags.len() as u32).to_be_bytes());
        let mut at = 132 + 12 * tags.len();
        for (name, data) in tags {
            bytes.extend(*name);
            bytes.extend(
                [at as u32, data.len() as u32]
                    .iter()
                    .flat_map(|n| n.to_be_bytes()),
            );
            at += data.len();
        }
        bytes.extend(tags.iter().flat_map(|(_, data)| data.clone()));
        bytes
    }

    fn fixed_of(kind: &[u8; 4], values: &[f64]) -> Vec<u8> {
        let mut bytes = [kind.as_slice(), &[0; 4]].concat();
        let fixed = values.iter().map(|value| (value * 65_536.0).round() as i32);
        bytes.extend(fixed.flat_map(i32::to_be_bytes));
        bytes
    }

    fn gamma(gamma: f64) -> Vec<u8> {
        let mut curve = b"curv\0\0\0\0\0\0\0\x01".to_vec();
        curve.extend(((gamma * 256.0).round() as u16).to_be_bytes());
        curve
    }

    fn rgb(name: &str, colorants: [[f64; 3]; 3], curve: &[u8]) -> Vec<u8> {
        let mut text = b"desc\0\0\0\0".to_vec();
        text.extend((name.len() as u32 + 1).to_be_bytes());
        text.extend(name.bytes().chain([0]));
        let [red, green, blue] = colorants.map(|values| fixed_of(b"XYZ ", &values));
        let tags: [(&[u8; 4], _); 7] = [
            (b"desc", text),
            (b"rXYZ", red),
            (b"gXYZ", green),
            (b"bXYZ", blue),
            (b"rTRC", curve.to_vec()),
            (b"gTRC", curve.to_vec()),
            (b"bTRC", curve.to_vec()),
        ];
        profile(b"RGB ", &tags)
    }

    /// Colorants of the profiles sRGB v2 of the ICC and Display P3 of Apple.
    const SRGB: [[f64; 3]; 3] = [
        [0.436_07, 0.222_49, 0.013_92],
        [0.385_15, 0.716_87, 0.097_08],
        [0.143_07, 0.060_61, 0.714_10],
    ];
    const P3: [[f64; 3]; 3] = [
        [0.515_12, 0.241_20, -0.001_05],
        [0.291_98, 0.692_25, 0.041_89],
        [0.157_10, 0.066_57, 0.784_07],
    ];

    #[test]
    fn profiles_of_srgb_are_known_and_others_are_named() {
        // IEC 61966-2-1 as a parametric curve of kind 3.
        let mut curve = b"para\0\0\0\0\0\x03\0\0".to_vec();
        let values = [2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.040_45];
        curve.extend_from_slice(&fixed_of(b"para", &values)[8..]);
        for curve in [&curve, &gamma(2.2)] {
            assert_eq!(foreign_profile(&rgb("sRGB", SRGB, curve)), None);
        }
        let p3 = foreign_profile(&rgb("Display P3", P3, &curve));
        assert_eq!(p3.as_deref(), Some("the colour profile \"Display P3\""));
        assert!(foreign_profile(&rgb("linear", SRGB, &gamma(1.0))).is_some());
        assert!(foreign_profile(&rgb("1.8", SRGB, &gamma(1.8))).is_some());
        let grey = |curve| profile(b"GRAY", &[(b"kTRC", curve)]);
        assert_eq!(foreign_profile(&grey(gamma(2.2))), None);
        assert!(foreign_profile(&grey(gamma(1.0))).is_some());
        assert!(foreign_profile(&profile(b"CMYK", &[])).is_some());
        let whole = rgb("Display P3", P3, &curve);
        for length in 0..whole.len() {
            foreign_profile(&whole[..length]);
        }
    }

    #[test]
    fn gamma_of_pngs_is_reported_unless_it_is_srgb_s() {
        let info = |gamma: Option<f32>, is_srgb: bool| {
            let mut info = png::Info::default();
            info.gama_chunk = gamma.map(png::ScaledFloat::new);
            info.srgb = is_srgb.then_some(png::SrgbRenderingIntent::Perceptual);
            Said::of_png(&info).note()
        };
        assert_eq!(info(None, false), None);
        assert_eq!(info(Some(0.45455), false), None);
        assert_eq!(info(Some(1.0), true), None);
        let said = info(Some(1.0), false).expect("linear");
        assert!(said.contains("gamma of 1.000"), "{said}");
    }

    #[test]
    fn orientation_is_read_in_both_byte_orders() {
        let big = b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0";
        let little = b"II\x2a\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0\x06\0\0\0\0\0\0\0";
        for exif in [big.as_slice(), little] {
            let said = Said::of_parts(Some(exif), None);
            assert_eq!(said.turned(), Some("on its side"));
            for length in 0..exif.len() - 8 {
                assert_eq!(exif_orientation(&exif[..length]), None);
            }
        }
        let upright = Said {
            orientation: Some(1),
            ..Said::default()
        };
        assert_eq!(upright.turned(), None);
    }
}
