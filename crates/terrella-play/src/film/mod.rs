//! Films as folders of frames: numbered images, and a page that describes each of them.
//!
//! An interrupted folder of frames can be continued: its page, `frames.json`, identifies the film and every finished frame with a checksum. It is
//! valid JSON at any time, even if the program is killed. If it is truncated nevertheless, its entries before the cut are kept.
//!
//! | file | content |
//! |---|---|
//! | `range` | the requested frames |
//! | `key` | identity of a film: program, scene, input files, settings |
//! | `folder` | names of frames, and the lock of a folder |
//! | `page` | `frames.json`: written frame by frame, and read back |
//! | `page_text` | parser of its text, also if truncated |
//! | `record` | the page's record of a frame |
//! | `settings` | how images are made and stored |
//! | `frames` | draws the frames of a scene's film, in any order |
//! | `shared_folder` | a folder that several processes write to |
//! | `painter` | draws frames as displayed, or as averaged light of many pixels and times |
//! | `bloom` | bloom on the CPU |
//! | `develop` | development of light into an image, on the CPU |
//! | `hdr` | development for high dynamic range displays |
//! | `over_light` | tracks and captions over such images |
//! | `picture` | an image and its file: PNG, PNG with 16 bits or of high dynamic range, OpenEXR |
//! | `error` | why a folder is rejected |

mod bloom;
mod develop;
mod error;
mod folder;
mod frames;
mod hdr;
mod key;
mod over_light;
mod page;
mod page_text;
mod painter;
mod picture;
mod range;
mod record;
mod settings;
mod shared_folder;

pub use develop::{LightPicture, PictureLook};
pub use error::FilmError;
pub use folder::{Existing, FrameFolder};
pub use frames::{DrawnFrame, FilmFrames};
pub use hdr::HdrPicture;
pub use key::{FilmInput, FilmKey, checksum};
pub use page::{FilmPage, KeptFrames, PageHead};
pub use painter::{FilmPainter, Painted};
pub use picture::FilmPicture;
pub use range::FrameRange;
pub use record::{CameraRecord, FrameRecord};
pub use settings::{PictureFormat, PictureSettings, Shutter};
pub use shared_folder::{FilmRequest, SharedFolder};
