//! Simulations of [Basilisk](https://avslab.github.io/basilisk/), connected at the endpoint of their viewer.
//!
//! A Basilisk script with `vizSupport.enableUnityVisualization` speaks ZeroMQ to a viewer. This module is the viewer's side: the wire protocol, the
//! messages, and the recorded state. It draws nothing.
//!
//! ```text
//! liveStream, noDisplay   REQ ──► endpoint ─ zmtp ─ server ─┐
//! broadcastStream         PUB ──► endpoint ─ zmtp ─ subscriber ─┼─► message ─► world ─► Snapshot ─► history, feeds
//! saveFile                .bin ─► recording ──────────────┘
//! ```
//!
//! | task | file |
//! |---|---|
//! | read a field of a message | `message.rs` (which fields), `wire.rs` (Protocol Buffers) |
//! | follow the processing of a step | `world.rs`: positions relative to the Earth's centre, epoch, messages to the user |
//! | find the pose of a camera | `camera.rs`, `attitude.rs` |
//! | find when a simulator gets its reply | `server.rs`, `shared.rs` |
//! | send user input to a script | `keys.rs` |
//! | play a saved simulation | `recording/`: the index of a file (`index.rs`), and playback |
//! | change limits | `message.rs` (sizes), `zmtp.rs` (frames, times), `orbit/connections.rs` (connections) |
//!
//! # Trust
//!
//! Endpoints are restricted to this machine unless [`SimulationOptions::allow_remote`] is set. There is no encryption and no authentication. A
//! message has at most 16 MiB, a simulation 1000 spacecraft and 262 144 recorded states. Four simulators may be connected; a connection counts as a
//! simulator from its first valid request on (`orbit/connections.rs`). An unreadable message is counted, reported once, and still gets a reply.

mod attitude;
mod camera;
mod endpoint;
mod feeds;
mod history;
mod keys;
mod message;
#[cfg(test)]
#[path = "../../../../tests/common/basilisk.rs"]
mod messages;
mod options;
mod recording;
mod server;
mod shared;
mod simulation;
mod subscriber;
mod undrawn;
mod wire;
mod world;
mod zmtp;

pub use camera::{CameraPose, camera_pose};
pub use endpoint::{BadEndpoint, Endpoint};
pub use feeds::{CraftFeed, PlaceFeed};
pub use message::{
    Body, Camera, Craft, EpochDate, Location, MAX_CAMERAS, MAX_CRAFT, MAX_LOCATIONS,
    MAX_MESSAGE_BYTES, Message,
};
pub use options::{Meeting, SimulationError, SimulationOptions};
pub use recording::{RecordedCraft, RecordedPlace, Recording, RecordingError};
pub use shared::{Counters, StepPace};
pub use simulation::{Painter, PictureRequest, Simulation, StepRequest};
pub use undrawn::Undrawn;
pub use wire::WireFault;
pub use world::{CraftState, Place, Roster, Snapshot, UpdateFault, World};
pub use zmtp::{Connection as ZmtpConnection, ZmtpError};
