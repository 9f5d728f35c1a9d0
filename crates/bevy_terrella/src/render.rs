//! Systems of the render world.
//!
//! | file | what |
//! |---|---|
//! | `extract.rs` | the Earth and its cameras from the main world; their status back to it |
//! | `eye.rs` | conversion of a Bevy camera to the library's view |
//! | `planet.rs` | an Earth for one format and sample count: built by a task, with a view for each camera
//! |
//! | `overlays.rs` | the sky beyond the Earth and the tracks over it, for each view |
//! | `prepare.rs` | all images of a frame |
//! | `draw.rs` | the pass of one camera |

mod draw;
mod extract;
mod eye;
mod overlays;
mod planet;
mod prepare;

use bevy::app::App;
use bevy::core_pipeline::core_3d::{main_opaque_pass_3d, main_transparent_pass_3d};
use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::ecs::schedule::IntoScheduleConfigs;
use bevy::ecs::system::ResMut;
use bevy::render::{ExtractSchedule, Render, RenderApp, RenderStartup, RenderSystems};
use planet::Planets;

/// Adds the systems of the render world, if it exists.
pub(crate) fn build(app: &mut App) {
    let Some(render) = app.get_sub_app_mut(RenderApp) else {
        tracing::warn!("without Bevy's RenderPlugin before TerrellaPlugin no Earth is drawn");
        return;
    };
    #[cfg(feature = "tracks")]
    render.add_systems(
        ExtractSchedule,
        extract::extract_tracks.after(extract::extract),
    );
    render
        .init_resource::<extract::SeenEarth>()
        .init_resource::<extract::Reports>()
        .init_resource::<Planets>()
        .add_systems(RenderStartup, forget)
        .add_systems(ExtractSchedule, (extract::report, extract::extract).chain())
        .add_systems(
            Render,
            prepare::prepare.in_set(RenderSystems::PrepareResources),
        )
        .add_systems(
            Core3d,
            draw::draw
                .after(main_opaque_pass_3d)
                .before(main_transparent_pass_3d)
                .in_set(Core3dSystems::MainPass),
        );
}

/// Bevy has a new device; objects of the old one are invalid.
fn forget(mut planets: ResMut<Planets>) {
    *planets = Planets::default();
}
