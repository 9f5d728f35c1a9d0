//! Simulations of [Basilisk](https://avslab.github.io/basilisk/), met where they look for their viewer.
//!
//! A script of Basilisk with `vizSupport.enableUnityVisualization` speaks ZeroMQ to a viewer. Here is that viewer's side: the wire
//! protocol, the messages, and what is kept of them. Nothing in here draws.
//!
//! ```text
//! liveStream, noDisplay   REQ ──► endpoint ─ zmtp ─ server ─┐
//! broadcastStream         PUB ──► endpoint ─ zmtp ─ subscriber ─┼─► message ─► world ─► Snapshot ─► history, feeds
//! saveFile                .bin ─► recording ──────────────┘
//! ```
//!
//! | to | look in |
//! |---|---|
//! | read a field of a message | `message.rs` (which fields), `wire.rs` (Protocol Buffers) |
//! | see what becomes of a step | `world.rs`: places about the Earth's centre, epoch, messages to the user |
//! | see where a camera looks | `camera.rs`, `attitude.rs` |
//! | see who is answered when | `server.rs`, `shared.rs` |
//! | send a script what a user does | `keys.rs` |
//! | play a saved simulation | `recording/`: what is held of a file (`index.rs`), and how it is played |
//! | change limits | `message.rs` (sizes), `zmtp.rs` (frames, times), `orbit/connections.rs` (connections) |
//!
//! # Trust
//!
//! Endpoints are of this machine alone unless [`SimulationOptions::allow_remote`] is set. Nothing is encrypted and nobody is asked
//! who he is. A message has at most 16 MiB, a simulation 1000 spacecraft and 262 144 states that are kept of them; four simulators
//! may be connected, of which a connection counts as one from its first good request on (`orbit/connections.rs`). What cannot be read is counted, reported once, and still answered.

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
