//! Ground truth as files: a folder of arrays, one image of all of them, and a page that describes them.
//!
//! `docs/truth.md` is the contract. Arrays are in NumPy's format; the image is OpenEXR, which has no 64-bit floats: such a layer is stored as two
//! channels, the nearest 32-bit float and the remainder.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::float_files::{write_exr_header, write_exr_line, write_npy_header};
use super::output::{OutputError, PendingFile, make_folder};
use super::raw_manifest::SensorCamera;
use super::seen_truth::{TruthEarth, seen_rows};
use super::sensor_bands::SensorView;
use super::truth_manifest::{PICTURE, TruthManifest};
use rayon::prelude::*;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;
use terrella::internals::offscreen::{LayerDtype, TRUTH_LAYERS, TruthPixel, check_truth_memory};
use terrella::{EarthOptions, GpuContext, TruthView};
use terrella_files::Unfinished;
use terrella_imagery::tile::TileKey;

/// The page that describes them.
const MANIFEST: &str = "truth.json";

/// A folder of truth on its way: its files are there under temporary names, and vanish if they are not committed.
#[derive(Debug)]
pub struct TruthFolder {
    arrays: Vec<PendingFile>,
    picture: PendingFile,
    manifest: PendingFile,
    // Last, so that the files in them are gone before.
    made: MadeFolders,
}

/// Folders that were created for the output: removed again if they are empty.
#[derive(Debug, Default)]
struct MadeFolders(Vec<Unfinished>);

impl MadeFolders {
    /// Makes a folder and those above it, where they are not there.
    fn make(folder: &Path) -> Result<Self, OutputError> {
        let missing = folder.ancestors().take_while(|path| !path.exists());
        let missing: Vec<_> = missing
            .filter(|path| !path.as_os_str().is_empty())
            .collect();
        let mut made = Self::default();
        for path in missing.into_iter().rev() {
            let ((), unfinished) = Unfinished::create(path, |path| std::fs::create_dir_all(path))
                .map_err(|source| OutputError::write(path, source))?;
            made.0.push(unfinished);
        }
        make_folder(folder)?;
        Ok(made)
    }
}

impl Drop for MadeFolders {
    fn drop(&mut self) {
        for folder in self.0.iter().rev() {
            // One that holds something stays.
            let _ = std::fs::remove_dir(folder.path());
        }
    }
}

impl TruthFolder {
    /// Makes the folder, where it is not there, and in it the files of a picture of this size.
    ///
    /// # Errors
    /// A place that cannot be written to; a picture that takes more memory than this program does.
    pub fn create(folder: &Path, size: (u32, u32)) -> Result<Self, PlayError> {
        check_truth_memory(size)?;
        let made = MadeFolders::make(folder)?;
        let file = |name: &str, ending| PendingFile::create(&folder.join(name), "layers", ending);
        Ok(Self {
            arrays: TRUTH_LAYERS
                .iter()
                .map(|layer| file(&layer.file(), "npy"))
                .collect::<Result<_, _>>()?,
            picture: file(PICTURE, "exr")?,
            manifest: file(MANIFEST, "json")?,
            made,
        })
    }

    /// Draws the truth of a moment and writes it, as yet under temporary names. Answers tiles that are missing.
    pub fn draw(
        &self,
        flight: &Flight,
        gpu: &GpuContext,
        options: EarthOptions,
        size: (u32, u32),
        moment: &Moment,
    ) -> Result<Vec<TileKey>, PlayError> {
        let has_water = options.layers.water.is_some();
        let figure = options.figure;
        let mut earth = TruthEarth::new(gpu, options)?;
        let mut lines = Lines::begin(self, size)?;
        let wait = flight.scene().output.wait();
        let (view, missing) = earth.draw(moment, size, wait, |view, y, texels| {
            let pixels = texels
                .par_iter()
                .zip(0..size.0)
                .map(|(texel, x)| TruthPixel {
                    point: view.point(x, y, texel),
                    limb_distance_rad: view.limb_distance_rad(x, y),
                    has_water,
                });
            Ok(lines.write(y, &pixels.collect::<Vec<_>>())?)
        })?;
        lines.end()?;
        let figure = figure.ellipsoid();
        self.write_page(&TruthManifest::new(
            flight, moment, &view, &figure, size, None,
        ))?;
        Ok(missing)
    }

    /// Draws the ground truth of a sensor's view: the rays of its pixels through its lens, each row at its own time. The surface properties from
    /// the GPU (elevation, slope, land, clouds) are those of the nearest sample; the position is computed on the pixel's own ray.
    pub fn draw_seen(
        &self,
        flight: &Flight,
        gpu: &GpuContext,
        options: EarthOptions,
        seen: &SensorView,
        moment: &Moment,
    ) -> Result<Vec<TileKey>, PlayError> {
        let figure = options.figure;
        let size: (u32, u32) = seen.sensor.lens.size().into();
        let mut lines = Lines::begin(self, size)?;
        let missing = seen_rows(flight, gpu, options, seen, |y, pixels| {
            Ok(lines.write(y, pixels)?)
        })?;
        lines.end()?;
        let view = TruthView::new(&moment.view, &moment.sky, figure, size);
        let view = view.ok_or(PlayError::NoTruth)?;
        let camera = SensorCamera::new(&seen.sensor, &seen.bands);
        let ellipsoid = figure.ellipsoid();
        let page = TruthManifest::new(flight, moment, &view, &ellipsoid, size, Some(camera));
        self.write_page(&page)?;
        Ok(missing)
    }

    fn write_page(&self, page: &TruthManifest) -> Result<(), OutputError> {
        let mut out = self.manifest.open()?;
        out.write_all(page.to_json().as_bytes())
            .and_then(|()| out.flush())
            .map_err(|source| write_error(&self.manifest, source))
    }

    /// Gives all files their names, the page last: where it is, all of its layers are.
    pub fn commit(self) -> Result<(), OutputError> {
        let Self {
            arrays,
            picture,
            manifest,
            mut made,
        } = self;
        // That of an earlier image lists other files.
        match std::fs::remove_file(manifest.target()) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                return Err(write_error(&manifest, source));
            }
            _ => {}
        }
        for file in arrays.into_iter().chain([picture, manifest]) {
            file.commit()?;
        }
        made.0.clear();
        Ok(())
    }
}

/// The files of the layers, as they are written line by line.
struct Lines<'f> {
    arrays: Vec<(&'f PendingFile, BufWriter<File>)>,
    picture: (&'f PendingFile, BufWriter<File>),
    /// The picture's channels in the order of their names, and for each its layer, and which of that layer's.
    order: Vec<(usize, usize)>,
}

impl<'f> Lines<'f> {
    fn begin(folder: &'f TruthFolder, size: (u32, u32)) -> Result<Self, OutputError> {
        let mut arrays = Vec::with_capacity(TRUTH_LAYERS.len());
        for (file, layer) in folder.arrays.iter().zip(TRUTH_LAYERS) {
            let mut out = file.open()?;
            let shape = layer.shape(size);
            write_npy_header(&mut out, layer.dtype.name(), &shape)
                .map_err(|source| write_error(file, source))?;
            arrays.push((file, out));
        }
        let mut channels: Vec<_> = (0..)
            .zip(TRUTH_LAYERS)
            .flat_map(|(n, layer)| {
                let names = layer.channels().into_iter();
                names.enumerate().map(move |(k, name)| (name, (n, k)))
            })
            .collect();
        channels.sort();
        let names: Vec<_> = channels.iter().map(|(name, _)| name.as_str()).collect();
        let mut out = folder.picture.open()?;
        write_exr_header(&mut out, size, &names)
            .map_err(|source| write_error(&folder.picture, source))?;
        Ok(Self {
            arrays,
            picture: (&folder.picture, out),
            order: channels.into_iter().map(|(_, place)| place).collect(),
        })
    }

    fn write(&mut self, y: u32, pixels: &[TruthPixel]) -> Result<(), OutputError> {
        let mut channels = Vec::with_capacity(TRUTH_LAYERS.len());
        for ((file, out), layer) in self.arrays.iter_mut().zip(TRUTH_LAYERS) {
            let mut of_layer = vec![Vec::with_capacity(pixels.len()); layer.channels().len()];
            for pixel in pixels {
                let values = layer.values(pixel);
                let written = match layer.dtype {
                    LayerDtype::F64 => {
                        let near = values[0] as f32;
                        of_layer[0].push(near);
                        of_layer[1].push((values[0] - f64::from(near)) as f32);
                        out.write_all(&values[0].to_le_bytes())
                    }
                    LayerDtype::F32 => {
                        of_layer
                            .iter_mut()
                            .zip(values)
                            .try_for_each(|(all, value)| {
                                all.push(value as f32);
                                out.write_all(&(value as f32).to_le_bytes())
                            })
                    }
                };
                written.map_err(|source| write_error(file, source))?;
            }
            channels.push(of_layer);
        }
        let (file, out) = &mut self.picture;
        let channels = self.order.iter().map(|(n, k)| channels[*n][*k].as_slice());
        write_exr_line(out, y, channels).map_err(|source| write_error(file, source))
    }

    fn end(mut self) -> Result<(), OutputError> {
        let files = self.arrays.iter_mut().chain([&mut self.picture]);
        for (file, out) in files {
            out.flush().map_err(|source| write_error(file, source))?;
        }
        Ok(())
    }
}

fn write_error(file: &PendingFile, source: io::Error) -> OutputError {
    OutputError::write(file.target(), source)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_was_made_is_taken_away() {
        let root = tempfile::tempdir().expect("a folder");
        let folder = root.path().join("new/truth");
        let truth = TruthFolder::create(&folder, (4, 3)).expect("made");
        assert!(folder.is_dir());
        drop(truth);
        assert!(!root.path().join("new").exists());
        std::fs::create_dir_all(&folder).expect("made");
        drop(TruthFolder::create(&folder, (4, 3)).expect("taken"));
        assert_eq!(std::fs::read_dir(&folder).expect("there").count(), 0);
    }

    #[test]
    fn the_page_of_an_earlier_picture_goes_before_its_files_do() {
        let root = tempfile::tempdir().expect("a folder");
        std::fs::write(root.path().join(MANIFEST), "old").expect("writes");
        let truth = TruthFolder::create(root.path(), (4, 3)).expect("taken");
        // The first layer cannot be given its name.
        std::fs::create_dir(root.path().join(TRUTH_LAYERS[0].file())).expect("made");
        truth.commit().expect_err("in the way");
        assert!(!root.path().join(MANIFEST).exists());
    }
}
