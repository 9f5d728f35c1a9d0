//! The reference renderer, which adapters are compared with and which draws if there is none.

use super::{Common, FrameArgs};
use crate::progress::Bars;
use clap::{Args, ValueEnum};
use terrella::ContextError;
use terrella_measure::{ReferenceRequest, write_reference_still};
use terrella_play::{Flight, PlayError};
use terrella_reference::SAMPLES;

/// Default number of rays along each side of a pixel.
const DEFAULT_SAMPLES: u32 = 4;

#[derive(Debug, Args)]
pub struct ReferenceArgs {
    /// Renderer: a graphics adapter, or the slow, exact reference renderer
    #[arg(long, value_enum, default_value_t = Renderer::Gpu)]
    renderer: Renderer,
    /// With --renderer reference: N × N rays per pixel, 1 to 16 [default: 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(
        i64::from(*SAMPLES.start())..=i64::from(*SAMPLES.end())
    ))]
    samples: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Renderer {
    /// Best graphics adapter, or the one that --adapter names
    Gpu,
    /// Ray tracing on the CPU in double precision; needs no adapter
    Reference,
}

impl ReferenceArgs {
    /// Whether the reference renderer was selected.
    pub fn is_chosen(&self) -> bool {
        self.renderer == Renderer::Reference
    }
}

/// Whether the reference renderer replaces the GPU: there is no adapter, none was named, and only an image is requested.
pub fn stands_in(args: &FrameArgs, common: &Common, error: &PlayError) -> bool {
    matches!(error, PlayError::Context(ContextError::NoAdapter))
        && common.adapter.is_none()
        && !args.wireframe
        && args.radiance.is_none()
        && args.raw.is_none()
        && args.pictures.first_given().is_none()
        && args.truth.is_none()
}

/// Draws the picture.
pub fn draw(args: &FrameArgs, flight: &Flight, bars: &Bars) -> anyhow::Result<()> {
    let request = ReferenceRequest {
        epoch: args.at,
        size: args.size,
        samples: args.reference.samples.unwrap_or(DEFAULT_SAMPLES),
        output: &args.output,
        stats: args.stats.as_deref(),
    };
    Ok(write_reference_still(flight, &request, bars)?)
}

/// The options that conflict, if any.
pub fn conflict(args: &FrameArgs, common: &Common) -> Option<&'static str> {
    if !args.reference.is_chosen() {
        return args.reference.samples.map(|_| {
            "--samples needs --renderer reference; for a graphics adapter, set samples under [output] in the scene"
        });
    }
    let conflicts = [
        (
            args.wireframe,
            "--wireframe needs a graphics adapter; the reference renderer has no triangles",
        ),
        (
            args.raw.is_some(),
            "--raw needs a graphics adapter; the reference renderer writes only an image",
        ),
        (
            args.radiance.is_some(),
            "--radiance needs a graphics adapter; the reference renderer writes only an image",
        ),
        (
            args.pictures.first_given().is_some(),
            "--format, --alpha, --supersample and --shutter need a graphics adapter; the reference renderer has --samples",
        ),
        (
            args.truth.is_some(),
            "--truth needs a graphics adapter; the reference renderer writes only an image",
        ),
        (
            common.adapter.is_some(),
            "--adapter conflicts with --renderer reference, which uses no adapter",
        ),
    ];
    let met = conflicts.into_iter().find(|(is_met, _)| *is_met);
    met.map(|(_, message)| message)
}
