//! Options of an Earth, and the folder of its maps.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::pointers::{read, text_if_any, write};
use std::ffi::c_char;
use std::path::PathBuf;
use terrella::{
    Atmosphere, CityLights, EarthLayers, EarthOptions, Exposure, GpuContext, LayerSelection,
    OffscreenEarth, SurfaceLight, UploadedMaps, find_textures, load_layers,
};

/// Options of an Earth. Fill them with `terrella_options_default`, then change what you need.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TerrellaOptions {
    /// Width of pictures, pixels.
    pub width: u32,
    /// Height of pictures, pixels.
    pub height: u32,
    /// Samples per pixel of displayed pictures, 1 or 4.
    pub samples: u32,
    /// Folder of maps; null takes that of the environment variable TERRELLA_TEXTURES, else `textures` or `../share/terrella/textures`
    /// beside the program, else that of the source tree that the library was built from.
    pub textures: *const c_char,
    /// Part of the name of the graphics adapter, letter case aside; null takes the best.
    pub adapter: *const c_char,
    /// Exposure value, EV.
    pub exposure_ev: f64,
    /// Whether each image is metered, 0 or 1, instead of `exposure_ev`.
    pub auto_exposure: u8,
    /// Whether the atmosphere is drawn, 0 or 1.
    pub air: u8,
    /// Whether clouds are drawn, 0 or 1.
    pub clouds: u8,
    /// Whether city lights are drawn, 0 or 1.
    pub night_lights: u8,
    /// Whether synthetic detail below the maps' texels is drawn, 0 or 1.
    pub detail: u8,
    /// Whether land and clouds reflect sunlight by direction, 0 or 1. With 0 they are Lambertian.
    pub directional_reflectance: u8,
}

impl TerrellaOptions {
    /// Rejects switches that are neither 0 nor 1: bytes of a program that did not fill its options.
    fn check_switches(&self) -> Result<(), Failure> {
        let switches = [
            ("auto_exposure", self.auto_exposure),
            ("air", self.air),
            ("clouds", self.clouds),
            ("night_lights", self.night_lights),
            ("detail", self.detail),
            ("directional_reflectance", self.directional_reflectance),
        ];
        match switches.iter().find(|(_, value)| *value > 1) {
            None => Ok(()),
            Some((name, value)) => Err(Failure::argument(format!(
                "options.{name}: {value} is neither 0 nor 1; fill the options with terrella_options_default first"
            ))),
        }
    }
}

/// Fills options with the defaults: 800 × 450 pixels, one sample each, the starter maps, the best adapter.
///
/// # Safety
/// `options` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_options_default(options: *mut TerrellaOptions) -> TerrellaStatus {
    let exposure_ev = match Exposure::default() {
        Exposure::Ev(ev) => ev,
        Exposure::Auto => 0.0,
    };
    let default = TerrellaOptions {
        width: 800,
        height: 450,
        samples: 1,
        textures: std::ptr::null(),
        adapter: std::ptr::null(),
        exposure_ev,
        auto_exposure: (Exposure::default() == Exposure::Auto).into(),
        air: 1,
        clouds: 1,
        night_lights: 1,
        detail: SurfaceLight::DEFAULT.detail.into(),
        directional_reflectance: SurfaceLight::DEFAULT.directional_reflectance.into(),
    };
    // SAFETY: the caller's promise.
    answer(|| unsafe { write(options, "options", default) })
}

/// The options in the library's types.
pub(crate) struct Wanted {
    pub size: (u32, u32),
    pub adapter: Option<String>,
    samples: u32,
    /// Folder of the maps, and those of them that are drawn.
    folder: PathBuf,
    maps: LayerSelection,
    detail: bool,
    directional_reflectance: bool,
    exposure: Exposure,
    has_air: bool,
}

impl Wanted {
    /// Reads options.
    ///
    /// # Safety
    /// `options` is null or points to options whose texts end with zero bytes.
    pub unsafe fn read(options: *const TerrellaOptions) -> Result<Self, Failure> {
        // SAFETY: the caller's promise.
        let options = unsafe { read(options, "options") }?;
        // SAFETY: the caller's promise about its texts.
        let textures = unsafe { text_if_any(options.textures, "options.textures") }?;
        // SAFETY: the same.
        let adapter = unsafe { text_if_any(options.adapter, "options.adapter") }?;
        if !matches!(options.samples, 1 | 4) {
            return Err(Failure::argument(format!(
                "options.samples: {} is neither 1 nor 4",
                options.samples
            )));
        }
        options.check_switches()?;
        let exposure = match options.auto_exposure != 0 {
            true => Exposure::Auto,
            false => Exposure::Ev(options.exposure_ev),
        };
        Ok(Self {
            size: (options.width, options.height),
            adapter: adapter.map(str::to_owned),
            samples: options.samples,
            folder: folder(textures, "options.textures")?,
            maps: LayerSelection {
                clouds: options.clouds != 0,
                night_lights: options.night_lights != 0,
                ..LayerSelection::default()
            },
            detail: options.detail != 0,
            directional_reflectance: options.directional_reflectance != 0,
            exposure,
            has_air: options.air != 0,
        })
    }

    /// The Earth's options with maps on the library's device, which the Earths of a process share.
    pub fn with_shared_maps(&self, gpu: &GpuContext) -> Result<EarthOptions, Failure> {
        let maps = OffscreenEarth::shared_layers(gpu, &self.folder, self.maps);
        let (layers, uploaded) = maps.map_err(Failure::file)?;
        self.options(layers, uploaded)
    }

    /// The Earth's options with maps in memory, for a device of the host.
    pub fn with_maps(&self) -> Result<EarthOptions, Failure> {
        let layers = load_layers(&self.folder, self.maps).map_err(Failure::file)?;
        self.options(layers, UploadedMaps::default())
    }

    fn options(
        &self,
        layers: EarthLayers,
        uploaded: UploadedMaps,
    ) -> Result<EarthOptions, Failure> {
        let mut earth = EarthOptions::new(layers);
        earth.uploaded = uploaded;
        earth.light.detail = self.detail;
        earth.light.directional_reflectance = self.directional_reflectance;
        if self.detail && self.maps.night_lights {
            earth.city_lights = CityLights::load(self.folder.as_path()).map_err(Failure::file)?;
        }
        earth.samples = self.samples;
        earth.exposure = self.exposure;
        if !self.has_air {
            earth.atmosphere = Atmosphere::None;
        }
        Ok(earth)
    }
}

/// The folder of maps, which exists.
pub(crate) fn folder(given: Option<&str>, name: &str) -> Result<PathBuf, Failure> {
    let Some(given) = given else {
        return find_textures().map_err(Failure::file);
    };
    let folder = PathBuf::from(given);
    if folder.is_dir() {
        return Ok(folder);
    }
    let fault = match folder.exists() {
        true => "is not a folder",
        false => "does not exist",
    };
    Err(Failure::file(format!(
        "{name}: {given} {fault}; give a folder of maps, or null for the default one"
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::MaybeUninit;

    #[test]
    fn switches_are_0_or_1() {
        let mut options = MaybeUninit::uninit();
        // SAFETY: writable memory, which the call fills.
        let default = unsafe {
            let status = terrella_options_default(options.as_mut_ptr());
            assert_eq!(status, TerrellaStatus::TERRELLA_OK);
            options.assume_init()
        };
        assert!(default.check_switches().is_ok());
        let wrong = TerrellaOptions { air: 7, ..default };
        let failure = wrong.check_switches().expect_err("neither");
        assert_eq!(failure.status, TerrellaStatus::TERRELLA_ARGUMENT);
        assert!(
            failure.words.starts_with("options.air: 7 "),
            "{}",
            failure.words
        );
    }

    #[test]
    fn a_folder_of_maps_exists() {
        let here = tempfile::tempdir().expect("a folder");
        let given = here.path().to_str().expect("UTF-8");
        assert_eq!(folder(Some(given), "textures").expect("there"), here.path());
        let file = here.path().join("file");
        std::fs::write(&file, "").expect("written");
        for (path, named) in [
            (here.path().join("none"), "does not exist"),
            (file, "is not a folder"),
        ] {
            let given = path.to_str().expect("UTF-8");
            let failure = folder(Some(given), "textures").expect_err("no folder");
            assert_eq!(failure.status, TerrellaStatus::TERRELLA_FILE);
            let words = failure.words;
            assert!(words.contains(given) && words.contains(named), "{words}");
        }
    }
}
