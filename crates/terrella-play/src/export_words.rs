//! Summary of a film before it is made.

use super::film::PictureFormat;
use super::outlook::LightOutlook;
use super::written::counted;
use crate::scene::Scene;
use std::path::Path;

/// A film that is about to be made.
pub(super) struct FilmWords<'w> {
    /// What is filmed.
    pub scene: &'w Scene,
    /// The video file, and its encoder.
    pub video: Option<(&'w Path, &'w str)>,
    /// The folder of pictures, and their format.
    pub pictures: Option<(&'w Path, PictureFormat)>,
    /// Width and height, pixels.
    pub size: (u32, u32),
    /// Number of requested frames, and of those that exist; `None` if a simulator determines it.
    pub frames: Option<(u64, u64)>,
    /// Frames a second.
    pub frame_rate_hz: f64,
    /// Its light; `None` where a simulator gives the time.
    pub light: Option<&'w LightOutlook>,
}

impl FilmWords<'_> {
    /// Lines to be said before it is made.
    pub fn lines(&self) -> Vec<String> {
        let (width, height) = self.size;
        let mut lines = vec![match self.frames {
            None => format!(
                "film: as many frames as the simulator requests, of {width} × {height} pixels"
            ),
            Some((wanted, kept)) => {
                let kept = match kept {
                    0 => String::new(),
                    kept => format!(", {kept} of them already rendered"),
                };
                format!(
                    "film: {} of {width} × {height} pixels{kept}: {:.1} s at {} frames a second",
                    counted(wanted, "frame"),
                    wanted as f64 / self.frame_rate_hz,
                    self.frame_rate_hz
                )
            }
        }];
        if let Some((path, encoder)) = self.video {
            lines.push(format!("video: {}, encoded by {encoder}", path.display()));
        }
        if let Some((folder, format)) = self.pictures {
            let format = format_name(format);
            lines.push(format!("images: in {}, {format}", folder.display()));
        }
        if let Some(light) = self.light {
            lines.extend(
                light
                    .sentences()
                    .into_iter()
                    .map(|line| format!("light: {line}")),
            );
            let advice = light.advice(self.scene);
            lines.extend(advice.map(|advice| format!("light: {advice}")));
        }
        lines
    }
}

/// What an interrupted film leaves, and how to go on with it. A film that a simulator requests cannot be resumed.
pub(super) fn left_words(has_frames: bool, has_video: bool, is_lockstep: bool) -> &'static str {
    match (has_frames, has_video, is_lockstep) {
        (true, false, false) => "finished frames are kept, and --resume continues with them",
        (true, false, true) => "finished frames are kept",
        (true, true, false) => {
            "finished frames are kept, and --resume without --video continues with them; the unfinished video is removed"
        }
        (true, true, true) => "finished frames are kept; the unfinished video is removed",
        (false, ..) => "the unfinished video is removed; a film of --frames can be resumed",
    }
}

fn format_name(format: PictureFormat) -> &'static str {
    match format {
        PictureFormat::Png => "PNG",
        PictureFormat::Png16 => "PNG of 16 bits",
        PictureFormat::Exr => "EXR",
        PictureFormat::Pq => "PNG of 16 bits, BT.2020 and PQ",
        PictureFormat::Hlg => "PNG of 16 bits, BT.2020 and HLG",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_frames_can_be_resumed() {
        let frames = left_words(true, false, false);
        assert_eq!(
            frames,
            "finished frames are kept, and --resume continues with them"
        );
        let both = left_words(true, true, false);
        assert!(both.contains("--resume without --video"), "{both}");
        let video = left_words(false, true, false);
        assert!(
            !video.contains("kept") && !video.contains("--resume"),
            "{video}"
        );
        for has_video in [false, true] {
            let words = left_words(true, has_video, true);
            assert!(!words.contains("--resume"), "{words}");
        }
    }
}
