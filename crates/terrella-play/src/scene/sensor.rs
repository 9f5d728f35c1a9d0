//! `[sensor]`: the lens, aperture, shutter and detector of the camera.

use super::choices::{DistortionModel, MosaicName, PsfName, ShutterName};
use super::error::SceneError;
use super::field::{Field, PathKind, range_text, whole};
use super::record::{KeyText, number_text};
use super::sensor_keys::{BANDS_NM, QUANTUM_EFFICIENCY, RawSensor};
use super::text::SceneText;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use terrella_files as files;
use terrella_sensor::{
    Detector, Distortion, Kernel, Lens, Mosaic, Psf, Radiometry, Sensor, SensorError, Shutter,
    limits,
};

/// `[sensor]`
#[derive(Clone, Debug, PartialEq)]
pub struct SensorTable {
    /// The checked sensor; a measured point spread is read by [`Self::open`].
    sensor: Sensor,
    /// The file of its point spread.
    pub kernel: Option<PathBuf>,
    /// Wavelength of its Airy disc, nanometres.
    pub wavelength_nm: Option<f64>,
}

/// Why a measured point spread cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: {problem}; psf_kernel in [sensor] names a text file of rows of numbers, as many in each as there are rows", path.display())]
pub struct KernelError {
    /// The file.
    pub path: PathBuf,
    /// The problem, with the line if known.
    pub problem: String,
}

impl SensorTable {
    /// The sensor, with its measured point spread read from the file.
    ///
    /// # Errors
    /// An unreadable file, or one without a kernel.
    pub fn open(&self) -> Result<Sensor, KernelError> {
        let mut sensor = self.sensor.clone();
        if let Some(path) = &self.kernel {
            let kernel = read_kernel(path).map_err(|problem| KernelError {
                path: path.clone(),
                problem,
            })?;
            sensor.psf = Psf::Measured(kernel);
        }
        Ok(sensor)
    }

    /// The lens.
    pub fn lens(&self) -> &Lens {
        &self.sensor.lens
    }

    /// Aperture and exposure.
    pub fn radiometry(&self) -> &Radiometry {
        &self.sensor.radiometry
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.lens().size()
    }

    /// Vertical field of view of a pinhole camera with the same focal length, degrees.
    pub fn fov_deg(&self) -> f64 {
        let [_, height] = self.size().map(f64::from);
        2.0 * (0.5 * height / self.lens().focal_px()).atan().to_degrees()
    }
}

/// Why keys of the table have no value.
const NO_SENSOR: &str = "the scene has no sensor";
/// Maximum size of a kernel file, bytes: twenty characters per number.
const MAX_KERNEL_BYTES: u64 = 2 << 20;

impl SceneText<'_> {
    /// Checks `[sensor]`. A scene without any of its keys has no sensor.
    pub(super) fn sensor(&self, raw: &RawSensor) -> Result<Option<SensorTable>, SceneError> {
        if raw.given().next().is_none() {
            for (key, _) in raw.declared() {
                raw.notes.note(key.name, Err(NO_SENSOR));
            }
            return Ok(None);
        }
        let lens = self.lens(raw)?;
        let oversampling =
            self.count(&raw.oversampling(), |range| format!("must be from {range}"))?;
        let radiometry = self.radiometry(raw)?;
        let (psf, kernel, wavelength_nm) = self.psf(raw, &lens, radiometry.f_number)?;
        let sensor = Sensor {
            lens,
            psf,
            oversampling,
            radiometry,
            detector: self.detector(raw)?,
            mosaic: match self.choice(&raw.mosaic())? {
                MosaicName::Mono => Mosaic::Mono,
                MosaicName::Rggb => Mosaic::Rggb,
                MosaicName::Bggr => Mosaic::Bggr,
                MosaicName::Grbg => Mosaic::Grbg,
                MosaicName::Gbrg => Mosaic::Gbrg,
            },
            shutter: self.shutter(raw)?,
            seed: u64::from(self.count(&raw.seed(), |range| format!("must be from {range}"))?),
        };
        let checked = sensor.check();
        checked.map_err(|error| self.no_sensor(raw, &error))?;
        Ok(Some(SensorTable {
            sensor,
            kernel,
            wavelength_nm,
        }))
    }

    fn lens(&self, raw: &RawSensor) -> Result<Lens, SceneError> {
        let size_field = raw.size();
        let range = &size_field.rule;
        let size = match size_field.given.map(|given| given.get_ref().as_slice()) {
            Some(&[width, height]) => [width, height].map(|side| whole(side, range)),
            _ => [None; 2],
        };
        let [Some(width), Some(height)] = size else {
            let advice = format!(
                "a sensor needs size = [width, height], each from {} pixels",
                range_text(range)
            );
            return Err(self.reject(&size_field, advice));
        };
        size_field.note(Ok(format!("[{width}, {height}]")));
        let focal_length_mm = self.needed(raw, &raw.focal_length_mm())?;
        let pixel_pitch_um = self.needed(raw, &raw.pixel_pitch_um())?;
        let principal = self.numbers(
            &raw.principal_point_px(),
            &[2],
            "[x, y], two numbers of pixels",
        )?;
        raw.principal_point_px()
            .note(listed(principal.as_deref(), "the middle of the sensor"));
        let model = self.choice(&raw.distortion_model())?;
        let field = raw.distortion();
        let counts: (&[usize], _) = match model {
            DistortionModel::BrownConrady => (
                &[4, 5, 8],
                "a list of 4, 5 or 8 numbers: k1, k2, p1, p2 and, where there are more, k3, k4, k5, k6",
            ),
            DistortionModel::Fisheye => (&[4], "a list of 4 numbers: k1, k2, k3, k4"),
        };
        let coefficients = self.numbers(&field, counts.0, counts.1)?;
        field.note(listed(coefficients.as_deref(), "all coefficients are 0"));
        let at = |k: usize| {
            let coefficients = coefficients.as_deref().unwrap_or_default();
            coefficients.get(k).copied().unwrap_or(0.0)
        };
        let distortion = match model {
            DistortionModel::BrownConrady => Distortion::BrownConrady(std::array::from_fn(at)),
            DistortionModel::Fisheye => Distortion::Fisheye(std::array::from_fn(at)),
        };
        let principal = match principal.as_deref() {
            Some(&[x, y]) => Some([x, y]),
            _ => None,
        };
        let lens = Lens::new(
            [width, height],
            focal_length_mm,
            pixel_pitch_um,
            principal,
            distortion,
        );
        lens.map_err(|error| self.no_sensor(raw, &error))
    }

    fn radiometry(&self, raw: &RawSensor) -> Result<Radiometry, SceneError> {
        let efficiency = raw.quantum_efficiency();
        let quantum_efficiency = self.three(&efficiency)?.unwrap_or(QUANTUM_EFFICIENCY);
        efficiency.note(listed(Some(&quantum_efficiency), ""));
        let vignetting_field = raw.vignetting();
        let vignetting = self.three(&vignetting_field)?;
        vignetting_field.note(listed(
            vignetting.as_ref().map(<[f64; 3]>::as_slice),
            "there is none besides",
        ));
        let bands = raw.bands_nm();
        let expected = "[[from, to], [from, to], [from, to]], nanometres of red, green and blue";
        let bands_nm = match bands.given.map(toml::Spanned::get_ref) {
            None => BANDS_NM,
            Some(toml::Value::Array(rows)) if rows.len() == 3 => {
                let mut read = BANDS_NM;
                for (band, row) in read.iter_mut().zip(rows) {
                    let numbers = number_list(row).filter(|numbers| numbers.len() == 2);
                    let numbers = numbers
                        .ok_or_else(|| self.reject(&bands, format!("must be {expected}")))?;
                    *band = [numbers[0], numbers[1]];
                }
                read
            }
            Some(_) => return Err(self.reject(&bands, format!("must be {expected}"))),
        };
        let texts = bands_nm.map(|[from, to]| format!("[{from}, {to}]"));
        bands.note(Ok(format!("[{}]", texts.join(", "))));
        Ok(Radiometry {
            f_number: self.needed(raw, &raw.f_number())?,
            exposure_s: self.needed(raw, &raw.exposure_s())?,
            transmission: self.quantity(&raw.transmission())?,
            bands_nm,
            quantum_efficiency,
            cos4: raw.cos4().is_on(),
            vignetting: vignetting.unwrap_or_default(),
        })
    }

    fn psf(
        &self,
        raw: &RawSensor,
        lens: &Lens,
        f_number: f64,
    ) -> Result<(Psf, Option<PathBuf>, Option<f64>), SceneError> {
        let psf = self.choice(&raw.psf())?;
        let (sigma, wavelength, kernel) = (
            raw.psf_sigma_px(),
            raw.psf_wavelength_nm(),
            raw.psf_kernel(),
        );
        if psf != PsfName::Gaussian {
            self.idle(
                &sigma,
                "psf is not \"gaussian\"",
                "has a meaning with psf = \"gaussian\" alone; leave it out or write that",
            )?;
        }
        if psf != PsfName::Airy {
            self.idle(
                &wavelength,
                "psf is not \"airy\"",
                "has a meaning with psf = \"airy\" alone; leave it out or write that",
            )?;
        }
        if psf != PsfName::Measured {
            self.idle(
                &kernel,
                "psf is not \"measured\"",
                "has a meaning with psf = \"measured\" alone; leave it out or write that",
            )?;
        }
        Ok(match psf {
            PsfName::None => (Psf::None, None, None),
            PsfName::Gaussian => {
                let sigma_px = self.quantity(&sigma)?;
                (Psf::Gaussian { sigma_px }, None, None)
            }
            PsfName::Airy => {
                let wavelength_nm = self.quantity(&wavelength)?;
                let lambda_n_px = 1e-3 * wavelength_nm * f_number / lens.pixel_pitch_um();
                (Psf::Airy { lambda_n_px }, None, Some(wavelength_nm))
            }
            PsfName::Measured => {
                let path = self.path(&kernel, PathKind::File, "")?;
                let path = path.ok_or_else(|| {
                    self.reject(&kernel, "psf = \"measured\" needs the file of its kernel")
                })?;
                // Read when needed, like all files.
                (Psf::None, Some(path), None)
            }
        })
    }

    fn detector(&self, raw: &RawSensor) -> Result<Detector, SceneError> {
        let bits = self.count(&raw.bits(), |range| format!("must be from {range}"))?;
        let bias_dn =
            f64::from(self.count(&raw.bias_dn(), |range| format!("must be from {range}"))?);
        let full_well_e = self.needed(raw, &raw.full_well_e())?;
        let white = f64::from((1_u32 << bits) - 1);
        if bias_dn >= white {
            let advice = format!("must be below {white}, the greatest number of {bits} bits");
            return Err(self.reject(&raw.bias_dn(), advice));
        }
        let gain = raw.gain_e_dn();
        let gain_e_dn = self.quantity_or(&gain, full_well_e / (white - bias_dn))?;
        let hot = raw.hot_pixel_e_s();
        let hot_pixel_fraction = self.quantity(&raw.hot_pixel_fraction())?;
        if hot_pixel_fraction == 0.0 {
            let advice =
                "has no meaning without hot pixels; give hot_pixel_fraction, or leave it out";
            self.idle(&hot, "there are no hot pixels", advice)?;
        }
        Ok(Detector {
            full_well_e,
            blooming: raw.blooming().is_on(),
            dark_current_e_s: self.quantity(&raw.dark_current_e_s())?,
            dsnu_e: self.quantity(&raw.dsnu_e())?,
            prnu: self.quantity(&raw.prnu())?,
            hot_pixel_fraction,
            hot_pixel_e_s: self.quantity(&hot)?,
            read_noise_e: self.quantity(&raw.read_noise_e())?,
            gain_e_dn,
            bias_dn,
            bits,
        })
    }

    fn shutter(&self, raw: &RawSensor) -> Result<Shutter, SceneError> {
        let line_time = raw.line_time_us();
        if self.choice(&raw.shutter())? == ShutterName::Global {
            let advice =
                "has a meaning with shutter = \"rolling\" alone; leave it out or write that";
            self.idle(&line_time, "all rows are exposed at once", advice)?;
            return Ok(Shutter::Global);
        }
        let line_time_us = self.quantity(&line_time)?;
        if line_time_us.abs() < *limits::LINE_TIME_US.start() {
            let advice = format!(
                "is too short for a rolling shutter; {} would work, or shutter = \"global\"",
                limits::LINE_TIME_US.start()
            );
            return Err(self.reject(&line_time, advice));
        }
        Ok(Shutter::Rolling {
            line_time_s: 1e-6 * line_time_us.abs(),
            from_below: line_time_us < 0.0,
        })
    }

    /// A required number.
    fn needed(
        &self,
        raw: &RawSensor,
        field: &Field<'_, f64, RangeInclusive<f64>>,
    ) -> Result<f64, SceneError> {
        if !field.is_given() {
            let remedy = format!("a sensor needs {}; give it in [sensor]", field.key);
            return Err(self.missing(field, raw.given(), remedy));
        }
        self.quantity_or(field, f64::NAN)
    }

    /// A list of finite numbers with one of these lengths, if given.
    fn numbers(
        &self,
        field: &Field<'_, toml::Value>,
        counts: &[usize],
        expected: &str,
    ) -> Result<Option<Vec<f64>>, SceneError> {
        let Some(given) = field.given else {
            return Ok(None);
        };
        let numbers = number_list(given.get_ref());
        let numbers = numbers.filter(|numbers| counts.contains(&numbers.len()));
        match numbers {
            Some(numbers) => Ok(Some(numbers)),
            None => Err(self.reject(field, format!("must be {expected}"))),
        }
    }

    /// Three numbers in their range, if given.
    fn three(
        &self,
        field: &Field<'_, Vec<f64>, RangeInclusive<f64>>,
    ) -> Result<Option<[f64; 3]>, SceneError> {
        let Some(given) = field.given else {
            return Ok(None);
        };
        let range = &field.rule;
        match given.get_ref().as_slice() {
            &[a, b, c] if [a, b, c].iter().all(|number| range.contains(number)) => {
                Ok(Some([a, b, c]))
            }
            _ => {
                let advice = format!("must be {}, each from {}", field.of, range_text(range));
                Err(self.reject(field, advice))
            }
        }
    }

    /// Rejects the key named by a sensor error.
    fn no_sensor(&self, raw: &RawSensor, error: &SensorError) -> SceneError {
        let place = raw.given().find(|(key, _)| key.name == error.key());
        // The faulty key may be absent, if a required one is too small or too large for its default.
        let place = place.or_else(|| raw.given().find(|(key, _)| key.name == "size"));
        let (key, span) = place.map_or((error.key(), 0..0), |(key, span)| (key.name, span));
        self.reject_at("sensor", key, span, error)
    }
}

/// A list in scene syntax, or why there is none.
fn listed(numbers: Option<&[f64]>, without: &'static str) -> KeyText {
    let texts = numbers
        .ok_or(without)?
        .iter()
        .map(|number| number_text(*number));
    Ok(format!("[{}]", texts.collect::<Vec<_>>().join(", ")))
}

fn number_list(value: &toml::Value) -> Option<Vec<f64>> {
    let numbers = value.as_array()?.iter().map(|value| match value {
        toml::Value::Integer(whole) => Some(*whole as f64),
        toml::Value::Float(number) => number.is_finite().then_some(*number),
        _ => None,
    });
    numbers.collect()
}

/// Reads rows of numbers separated by spaces or commas; `#` starts a comment.
fn read_kernel(path: &Path) -> Result<Kernel, String> {
    let text = files::read_text(path, MAX_KERNEL_BYTES).map_err(|error| error.to_string())?;
    let text = text.ok_or_else(|| format!("has more than {} MiB", MAX_KERNEL_BYTES >> 20))?;
    let (mut samples, mut rows) = (Vec::new(), 0);
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default();
        let before = samples.len();
        let words = line.split([' ', ',', '\t', '\r']);
        for word in words.filter(|word| !word.is_empty()) {
            let sample = word.parse::<f64>();
            let no_number = |_| format!("line {number}: {:?} is no number", files::excerpt(word));
            samples.push(sample.map_err(no_number)?);
        }
        rows += usize::from(samples.len() > before);
    }
    Kernel::new(rows, samples).map_err(|error| error.to_string())
}

#[cfg(test)]
#[path = "sensor_tests.rs"]
mod tests;
