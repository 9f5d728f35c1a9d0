//! `terrella check`

use super::scene_args::{SatelliteArgs, SceneArgs, open_flight};
use super::{Common, print};
use clap::Args;
use terrella::frames::rfc3339;
use terrella_orbit::Feed;
use terrella_play::{Flight, LightOutlook};

/// Limit on satellites that are listed one by one.
const MAX_LISTED: usize = 50;

/// Arguments of `terrella check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    satellites: SatelliteArgs,
    /// List every key that a scene can have, including those without effect in this one
    #[arg(long)]
    all: bool,
}

/// Loads the scene and its files and prints a summary.
pub fn run(args: &CheckArgs, common: &Common) -> anyhow::Result<()> {
    let scene = args.scene.load(&args.satellites.satellite)?;
    args.satellites.reject_scenes("check", &scene);
    let flight = open_flight(scene, Flight::open_without_listening)?;
    flight.check_files()?;
    let dropped = flight.dropped_layers()?;
    if common.quiet {
        return Ok(());
    }
    let mut text = match args.all {
        true => flight.scene().full_summary(),
        false => flight.scene().summary(),
    };
    if !dropped.is_empty() {
        text.push_str("\nmissing, so left out\n");
    }
    for dropped in dropped {
        text.push_str(&format!("  {:<14} {}\n", dropped.layer, dropped.missing));
    }
    for note in flight.colour_notes() {
        text.push_str(&format!("\ncolours\n  {note}\n"));
    }
    let satellites = flight.satellites();
    for (index, satellite) in satellites.iter().enumerate() {
        let is_listed = index < MAX_LISTED || index == flight.followed();
        if !is_listed && satellite.faults().0.is_empty() {
            continue;
        }
        if let Some(feed) = satellite.live() {
            let head = match index == flight.followed() {
                true => "satellite",
                false => "satellite, not followed",
            };
            let (name, on) = (satellite.name(), &feed.options().transport);
            text.push_str(&format!(
                "\n{head}\n  {:<14} {name}\n  {:<14} when a simulator sends on {on}\n",
                "name", "known"
            ));
            continue;
        }
        let (first, last) = satellite.feed().validity();
        let head = match index == flight.followed() {
            true => "satellite",
            false => "satellite, not followed",
        };
        text.push_str(&format!(
            "\n{head}\n  {:<14} {}\n  {:<14} {} to {}\n",
            "name",
            satellite.name(),
            match satellite.elements() {
                Some(_) => "elements valid",
                None => "known",
            },
            rfc3339(first),
            rfc3339(last)
        ));
        text.push_str(&limits(satellite.feed()));
        let (faults, left_out) = satellite.faults();
        for fault in faults {
            text.push_str(&format!("  {:<14} {}\n", fault.label, fault.text));
        }
        if left_out > 0 {
            text.push_str(&format!("  {:<14} {left_out} more\n", "skipped"));
        }
    }
    if satellites.len() > MAX_LISTED {
        text.push_str(&format!(
            "\n{} satellites in all; terrella orbit --names lists them\n",
            satellites.len()
        ));
    }
    text.push_str(&light(&flight));
    if let Some(table) = flight.earth_orientation() {
        let (first, last) = table.span();
        let measured = table.measured_until();
        text.push_str(&format!(
            "\norientation of the Earth\n  {:<14} {} to {}\n  {:<14} {}\n",
            "table",
            rfc3339(first),
            rfc3339(last),
            "measured until",
            measured.map_or_else(|| "all of it is predicted".to_owned(), rfc3339)
        ));
    }
    print(&text)
}

/// Light conditions during the scene's film; empty if a simulator gives the time.
fn light(flight: &Flight) -> String {
    let scene = flight.scene();
    if scene.is_live() {
        return String::new();
    }
    let lines = match LightOutlook::of(flight, 0..scene.time.frame_count()) {
        Ok(light) => light.sentences(),
        Err(error) => vec![format!("not known: {error}")],
    };
    let lines = lines.iter().map(|line| format!("  {line}\n"));
    format!("\nlight\n{}", lines.collect::<String>())
}

/// Limit on printed gaps of an ephemeris.
const GAPS_TOLD: usize = 10;

/// Times within a satellite's file at which its state is not known.
fn limits(feed: &dyn Feed) -> String {
    let mut text = String::new();
    let (before, after) = feed.decay();
    for (side, end) in [("before", before), ("after", after)] {
        if let Some(end) = end {
            let end = rfc3339(end);
            text.push_str(&format!(
                "  {:<14} SGP4 has no orbit {side} {end}\n",
                "decay"
            ));
        }
    }
    let gaps = feed.gaps();
    for (from, to) in gaps.iter().take(GAPS_TOLD) {
        let (from, to) = (rfc3339(*from), rfc3339(*to));
        text.push_str(&format!("  {:<14} {from} to {to}\n", "not known"));
    }
    let more = gaps.len().saturating_sub(GAPS_TOLD);
    if more > 0 {
        text.push_str(&format!("  {:<14} in {more} more gaps\n", "not known"));
    }
    text
}
