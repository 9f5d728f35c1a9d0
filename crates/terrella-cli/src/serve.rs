//! `terrella serve`

use super::Common;
use super::interruption::{do_first, stop_by_itself};
use super::progress::Bars;
use super::scene_args::{SettingArgs, load};
use super::values;
use clap::Args;
use std::path::{Path, PathBuf};
use terrella_orbit::basilisk::{Endpoint, Meeting};
use terrella_play::scene::{Scene, Setting};
use terrella_play::{Flight, ServeRequest, serve};

/// Arguments of `terrella serve`.
#[derive(Debug, Args)]
pub struct ServeArgs {
    /// Scene file, with source = "basilisk" in [orbit] [default: the built-in scene, config/basilisk.toml]
    scene: Option<PathBuf>,
    #[command(flatten)]
    settings: SettingArgs,
    /// Address that simulations connect to [default: the scene's]
    #[arg(long, value_name = "tcp://ADDRESS:PORT")]
    listen: Option<Endpoint>,
    /// Exit when the first simulation has disconnected
    #[arg(long)]
    once: bool,
    /// Exit after this many seconds
    #[arg(long, value_name = "N", value_parser = values::seconds)]
    for_seconds: Option<f64>,
}

/// A scene of a simulation, met at `listen` where that is given.
pub fn simulation_scene(
    path: Option<&Path>,
    listen: Option<&Endpoint>,
    strict: bool,
    settings: &[Setting],
) -> anyhow::Result<Scene> {
    let mut scene = match path {
        Some(path) => load(Some(path), &[], strict, settings)?,
        None => Scene::of_simulations_with(settings)?,
    };
    if let Some(endpoint) = listen {
        let options = scene
            .orbits
            .iter_mut()
            .find_map(|orbit| orbit.basilisk.as_mut());
        match options {
            Some(options) => options.meeting = Meeting::Listen(endpoint.clone()),
            None => anyhow::bail!(
                "{}: --listen needs a scene with source = \"basilisk\" in [orbit]",
                scene.path.display()
            ),
        }
    }
    Ok(scene)
}

/// Answers simulations until it is stopped.
pub fn run(args: &ServeArgs, common: &Common) -> anyhow::Result<()> {
    let settings = &args.settings.set;
    let scene = simulation_scene(args.scene.as_deref(), args.listen.as_ref(), false, settings)?;
    let flight = Flight::open(scene)?;
    // Whoever waits is answered before the program ends.
    if let Some(simulation) = flight.simulation() {
        do_first(simulation.stopper());
    }
    stop_by_itself();
    let bars = Bars::new(common.quiet);
    let request = ServeRequest {
        adapter: common.adapter.as_deref(),
        for_seconds: args.for_seconds,
        once: args.once,
    };
    let endpoint = flight.simulation().map(|one| one.endpoint().to_string());
    let endpoint = endpoint.unwrap_or_default();
    let ready = |adapter: &str| {
        if !common.quiet {
            eprintln!(
                "listening for simulations on {endpoint}, rendering with {adapter}; Ctrl-C to stop"
            );
        }
    };
    let counters = serve(&flight, &request, &bars, ready)?;
    let mean_ms = |us: u64, count: u64| us as f64 / 1e3 / count.max(1) as f64;
    super::print(&format!(
        "{} steps, answered in {:.3} ms on average, {:.1} ms at most\n{} images, in {:.1} ms on average, {:.1} ms at most; {} requested and not rendered\n",
        counters.steps,
        mean_ms(counters.steps_us, counters.steps),
        counters.slowest_step_us as f64 / 1e3,
        counters.pictures,
        mean_ms(
            counters.pictures_us,
            counters.pictures + counters.no_pictures
        ),
        counters.slowest_picture_us as f64 / 1e3,
        counters.no_pictures,
    ))
}
