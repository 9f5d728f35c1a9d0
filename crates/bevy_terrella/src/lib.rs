//! The Earth in [Bevy](https://bevy.org): Terrella drawn in Bevy's own pass, with its depth.
//!
//! ```no_run
//! use bevy::prelude::*;
//! use bevy_terrella::prelude::*;
//!
//! fn add(app: &mut App) {
//!     app.add_plugins(TerrellaPlugin).add_systems(Startup, |mut commands: Commands| {
//!         let place = Geodetic::from_degrees(28.0, 30.0, 420_000.0);
//!         commands.spawn((Earth::default(), EarthFrame::local(place), EarthClock::default()));
//!         commands.spawn(EarthCamera::default());
//!     });
//! }
//! ```
//!
//! | component | on | says |
//! |---|---|---|
//! | [`Earth`] | one entity | maps and look |
//! | [`EarthFrame`] | the same | where the world's origin and axes are on the Earth, in f64 |
//! | [`EarthEpoch`], [`EarthClock`] | the same | time, and its rate |
//! | [`EarthSky`] | the same | lights at that time, computed |
//! | [`EarthCamera`] | each `Camera3d` that sees it | exposure |
//! | [`EarthCameraStatus`] | the same | whether it is drawn, what was drawn, or why not |
//! | [`EarthSun`] | a `DirectionalLight` | makes it the Sun |
//! | `EarthCelestial` (feature `celestial`) | the Earth's entity | stars, Milky Way, Sun and Moon are drawn |
//! | `EarthTrack` (feature `tracks`) | an entity for each satellite | its trail, ground track, footprint and marker |
//! | `EarthStation`, `EarthLines` (feature `tracks`) | separate entities | ground stations; lines on the globe |
//! | `EarthSensor` (feature `sensor`) | a camera's entity | lens and detector: raw frames |
//!
//! # One frame
//!
//! ```text
//!  main world                          render world
//!  EarthClock ─► EarthEpoch ─► EarthSky
//!                    │            │
//!  EarthFrame ───────┴────────────┴─► extract ─► prepare ──────────► draw, once a camera, in Core3d:
//!  EarthCamera ──────────────────────►    │      PrepareResources    after the opaque pass,
//!  EarthCameraStatus ◄── report ◄─────────┴──────── (all cameras     before the transparent one
//!                      (next frame)                  in one call)
//! ```
//!
//! `prepare` is one call for all cameras of a format and sample count, because Bevy submits them together. Each camera has its own
//! [`EarthView`](terrella::EarthView). If a camera needs an Earth that does not exist yet, a task builds it. On a new device (`RenderStartup`)
//! everything is rebuilt.
//!
//! The Earth is not in Bevy's prepass. Effects based on it (ambient occlusion, depth of field, motion vectors) ignore the Earth.

#[cfg(feature = "celestial")]
mod celestial;
mod earth;
mod fault;
mod frame;
mod maps;
mod render;
#[cfg(feature = "sensor")]
mod sensor;
mod sun;
mod time;
#[cfg(feature = "tracks")]
mod tracks;

#[cfg(feature = "celestial")]
pub use celestial::EarthCelestial;
pub use earth::{Earth, EarthCamera, EarthCameraStatus};
pub use fault::EarthFault;
pub use frame::EarthFrame;
pub use maps::EarthMaps;
#[cfg(feature = "sensor")]
pub use sensor::{EarthSensor, RawFrameTaken, TakeRawFrame};
pub use sun::EarthSun;
pub use terrella;
#[cfg(feature = "sensor")]
pub use terrella_sensor;
pub use time::{EarthClock, EarthEpoch, EarthSky};
#[cfg(feature = "tracks")]
pub use tracks::{EarthLines, EarthStation, EarthTrack};

/// Items of the plugin for apps, with the types of places and times in its components.
pub mod prelude {
    #[cfg(feature = "celestial")]
    pub use crate::EarthCelestial;
    pub use crate::{
        Earth, EarthCamera, EarthCameraStatus, EarthClock, EarthEpoch, EarthFault, EarthFrame,
        EarthMaps, EarthSky, EarthSun, TerrellaPlugin, TerrellaSystems,
    };
    #[cfg(feature = "tracks")]
    pub use crate::{EarthLines, EarthStation, EarthTrack};
    #[cfg(feature = "sensor")]
    pub use crate::{EarthSensor, RawFrameTaken, TakeRawFrame};
    pub use terrella::frames::{Epoch, Geodetic};
}

use bevy::app::{App, Plugin, PostUpdate, PreUpdate};
use bevy::ecs::schedule::{IntoScheduleConfigs, SystemSet};
use bevy::transform::TransformSystems;

/// Draws the [`Earth`] for every [`EarthCamera`]. Add it after Bevy's `RenderPlugin` (`DefaultPlugins`); without one it draws nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct TerrellaPlugin;

/// When the plugin's systems of the main world run.
#[derive(SystemSet, Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TerrellaSystems {
    /// [`EarthClock`] advances [`EarthEpoch`]: in `PreUpdate`.
    Clock,
    /// [`EarthSky`] is computed: in `PostUpdate`.
    Sky,
    /// [`EarthSun`] aims its light: in `PostUpdate`, after [`Self::Sky`] and before transforms are propagated.
    Sun,
}

impl Plugin for TerrellaPlugin {
    fn build(&self, app: &mut App) {
        let (sky, sun) = (TerrellaSystems::Sky, TerrellaSystems::Sun);
        let order = (sky, sun).chain().before(TransformSystems::Propagate);
        app.register_type::<Earth>()
            .register_type::<EarthCamera>()
            .register_type::<EarthCameraStatus>()
            .register_type::<EarthEpoch>()
            .register_type::<EarthSky>()
            .register_type::<EarthFrame>()
            .register_type::<EarthClock>()
            .register_type::<EarthSun>();
        #[cfg(feature = "celestial")]
        app.register_type::<EarthCelestial>();
        #[cfg(feature = "tracks")]
        app.register_type::<EarthTrack>()
            .register_type::<EarthStation>()
            .register_type::<EarthLines>();
        app.configure_sets(PostUpdate, order)
            .add_systems(
                PreUpdate,
                time::advance_epochs.in_set(TerrellaSystems::Clock),
            )
            .add_systems(
                PostUpdate,
                (time::compute_skies.in_set(sky), sun::aim_suns.in_set(sun)),
            );
        #[cfg(feature = "sensor")]
        sensor::build(app);
        render::build(app);
    }
}

#[cfg(test)]
mod tests {
    use crate::prelude::*;
    use bevy::camera::Camera3d;
    use bevy::core_pipeline::tonemapping::Tonemapping;
    use bevy::ecs::reflect::{AppTypeRegistry, ReflectComponent};
    use bevy::prelude::App;
    use std::any::TypeId;

    #[test]
    fn components_are_reflected_and_bring_what_they_need() {
        let mut app = App::new();
        app.add_plugins(TerrellaPlugin);
        let registry = app.world().resource::<AppTypeRegistry>().read();
        for id in [
            TypeId::of::<Earth>(),
            TypeId::of::<EarthCamera>(),
            TypeId::of::<EarthCameraStatus>(),
            TypeId::of::<EarthClock>(),
            TypeId::of::<EarthEpoch>(),
            TypeId::of::<EarthFrame>(),
            TypeId::of::<EarthSky>(),
            TypeId::of::<EarthSun>(),
            #[cfg(feature = "celestial")]
            TypeId::of::<EarthCelestial>(),
            #[cfg(feature = "tracks")]
            TypeId::of::<EarthTrack>(),
            #[cfg(feature = "tracks")]
            TypeId::of::<EarthStation>(),
            #[cfg(feature = "tracks")]
            TypeId::of::<EarthLines>(),
            #[cfg(feature = "sensor")]
            TypeId::of::<EarthSensor>(),
        ] {
            let registration = registry.get(id).expect("a registered component");
            assert!(registration.data::<ReflectComponent>().is_some());
        }
        drop(registry);
        let camera = app.world_mut().spawn(EarthCamera::default());
        assert!(camera.contains::<Camera3d>() && camera.contains::<EarthCameraStatus>());
        assert!(camera.contains::<Tonemapping>());
    }
}
