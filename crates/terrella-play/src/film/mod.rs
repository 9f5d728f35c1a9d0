//! Films as folders of frames: numbered pictures, and a page that says what each of them is.
//!
//! A folder of frames can be left and gone on with: its page, `frames.json`, names the film that it holds and every frame that is
//! done, with a checksum, and is good JSON at any moment, also where the program is killed. Of one that is cut anyway, its entries up to
//! the cut are kept.
//!
//! | file | what |
//! |---|---|
//! | `range` | which frames are wanted |
//! | `key` | what makes a film another film: program, scene, the files that its pictures come from, settings |
//! | `folder` | names of frames, and one run at a time in a folder |
//! | `page` | `frames.json`: written frame by frame, read again |
//! | `page_text` | its text in parts, also where it is cut off |
//! | `record` | what the page says of a frame |
//! | `settings` | how pictures are made and kept |
//! | `frames` | draws the frames of a scene's film, in any order |
//! | `shared_folder` | a folder that several processes fill |
//! | `painter` | draws them: as a screen shows them, or as light of many pixels and instants |
//! | `bloom` | light that a lens scatters, on the processor |
//! | `develop` | from light to a picture, on the processor |
//! | `hdr` | the same for displays of high dynamic range |
//! | `over_light` | captions that stand over such pictures |
//! | `picture` | a picture and its file: PNG, PNG with 16 bits or of high dynamic range, OpenEXR |
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
