//! What is said of a film before it is made, and of its files after.

use super::export::ExportRequest;
use super::film::PictureFormat;
use super::outlook::LightOutlook;
use std::path::PathBuf;
use std::time::Duration;

/// A film that is about to be made.
pub(super) struct FilmWords<'w> {
    /// What was asked for.
    pub request: &'w ExportRequest<'w>,
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Frames that are wanted, and those of them that are there; `None` where a simulator says how many there are.
    pub frames: Option<(u64, u64)>,
    /// Frames a second.
    pub frame_rate_hz: f64,
    /// What encodes its video, if there is one.
    pub encoder: Option<&'w str>,
    /// Its light; `None` where a simulator gives the time.
    pub light: Option<&'w LightOutlook>,
}

impl FilmWords<'_> {
    /// Lines to be said before it is made.
    pub fn lines(&self) -> Vec<String> {
        let (width, height) = self.size;
        let mut lines = vec![match self.frames {
            None => format!(
                "film: as many frames as the simulator asks for, of {width} × {height} pixels"
            ),
            Some((wanted, kept)) => {
                let kept = match kept {
                    0 => String::new(),
                    kept => format!(", {kept} of them there already"),
                };
                format!(
                    "film: {} of {width} × {height} pixels{kept}: {:.1} s at {} frames a second",
                    counted(wanted, "frame"),
                    wanted as f64 / self.frame_rate_hz,
                    self.frame_rate_hz
                )
            }
        }];
        if let (Some(path), Some(encoder)) = (self.request.video, self.encoder) {
            lines.push(format!("video: {}, encoded by {encoder}", path.display()));
        }
        if let Some(folder) = self.request.frames {
            let format = format_name(self.request.pictures.format);
            lines.push(format!("pictures: in {}, {format}", folder.display()));
        }
        if let Some(light) = self.light {
            lines.extend(
                light
                    .sentences()
                    .into_iter()
                    .map(|line| format!("light: {line}")),
            );
            lines.extend(light.advice().map(|advice| format!("light: {advice}")));
        }
        lines
    }
}

/// A file, or the files of a folder, written.
pub struct Written {
    /// The file, or the folder.
    pub path: PathBuf,
    /// Bytes of all that was written.
    pub bytes: u64,
    /// Pictures that were written, where it is a folder.
    pub pictures: Option<u64>,
}

impl Written {
    /// A file under its final name.
    pub fn file(path: PathBuf) -> Self {
        let bytes = std::fs::metadata(&path).map_or(0, |found| found.len());
        Self {
            path,
            bytes,
            pictures: None,
        }
    }

    /// The line to be said of it.
    pub(super) fn line(&self, frames: u64, elapsed: Duration) -> String {
        let what = match self.pictures {
            None => counted(frames, "frame"),
            Some(pictures) => counted(pictures, "picture"),
        };
        format!(
            "{}: {}, {what}, {:.1} s",
            self.path.display(),
            size_text(self.bytes),
            elapsed.as_secs_f64()
        )
    }
}

fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

fn format_name(format: PictureFormat) -> &'static str {
    match format {
        PictureFormat::Png => "PNG",
        PictureFormat::Png16 => "PNG of 16 bits",
        PictureFormat::Exr => "EXR",
    }
}

/// Bytes, and the same in the largest unit that leaves a whole one.
fn size_text(bytes: u64) -> String {
    let units = [(1e9, "GB"), (1e6, "MB"), (1e3, "kB")];
    let unit = units.iter().find(|(unit, _)| bytes as f64 >= *unit);
    match unit {
        Some((unit, name)) => format!("{:.1} {name} ({bytes} bytes)", bytes as f64 / unit),
        None => counted(bytes, "byte"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_told_in_bytes_and_for_people() {
        assert_eq!(size_text(1), "1 byte");
        assert_eq!(size_text(999), "999 bytes");
        assert_eq!(size_text(1_000), "1.0 kB (1000 bytes)");
        assert_eq!(size_text(12_345_678), "12.3 MB (12345678 bytes)");
        assert_eq!(size_text(5_000_000_000), "5.0 GB (5000000000 bytes)");
    }
}
