//! What pictures of a scene hold, and the order in which it is prepared and drawn: of a window's pictures and of those without one.

use super::captions::CaptionLayer;
#[cfg(feature = "window")]
use super::coverage_layer::CoverageLegend;
use super::coverage_layer::coverage_legend;
use super::craft::CraftLayer;
use super::dated_maps::DatedMapsLayer;
use super::egui_pass::EguiTarget;
use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::model_layer::ModelLayer;
use super::sky::SkyLayer;
use super::tracks::{ShownTracks, TrackDetail, TracksLayer};
use crate::scene::Scene;
use std::time::Duration;
use terrella::celestial::CelestialOptions;
use terrella::{
    Adaptation, Earth, EarthError, EarthOptions, Exposure, EyeView, FrameRequest, FrameStats,
    GpuContext, Quality,
};
use terrella_imagery::tile::TileKey;

/// The Earth, and what a scene has beside it: a craft, maps of the date, the sky and tracks.
pub struct ScenePainter {
    gpu: GpuContext,
    earth: Earth,
    craft: CraftLayer,
    models: Option<ModelLayer>,
    dated_maps: Option<DatedMapsLayer>,
    sky: Option<SkyLayer>,
    tracks: Option<TracksLayer>,
    captions: Option<CaptionLayer>,
    /// Format of the finished picture.
    shown: wgpu::TextureFormat,
    /// Whether the sky is kept and not drawn.
    hides_sky: bool,
    /// Follows the exposure that views ask for, where it is metered.
    adaptation: Option<Adaptation>,
    /// The shot that was exposed last.
    shot: usize,
    /// Number of the frame that was prepared last, of the scene's film.
    frame: u32,
    /// Whether moments with an exposure of their own are exposed as all others.
    has_user_exposure: bool,
    /// Whether stars keep their gain beside daylight.
    keeps_star_gain: bool,
}

/// Textures that a picture is drawn to.
pub trait PictureTarget {
    /// Width and height of the picture, pixels.
    fn size(&self) -> (u32, u32);

    /// Width and height that are drawn before they are enlarged to [`Self::size`], pixels.
    fn drawn_size(&self) -> (u32, u32);

    /// Begins the pass that draws it: black space, depth infinitely far.
    fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e>;

    /// Has the pictures made from now on show the grain of a frame of a film.
    fn set_frame(&self, queue: &wgpu::Queue, frame: u32);

    /// Makes the picture of what that pass drew, where that is no picture yet.
    fn finish(&self, encoder: &mut wgpu::CommandEncoder);

    /// The finished picture.
    fn view(&self) -> &wgpu::TextureView;
}

/// How long a picture may wait, and how much of its tracks it shows.
#[derive(Clone, Copy)]
pub enum Patience {
    /// Drawn with what is there; tracks grow over the next pictures.
    Live,
    /// Drawn with what is there, and whole tracks.
    WholeTracks,
    /// The same, when all tiles that it wants have come or this time is over.
    Complete(Duration),
}

impl ScenePainter {
    /// Uploads the maps, for pictures of the format `shown`; the Earth alone is drawn until layers are added by the methods below.
    pub fn new(
        gpu: GpuContext,
        options: &EarthOptions,
        shown: wgpu::TextureFormat,
    ) -> Result<Self, PlayError> {
        Ok(Self {
            earth: Earth::new(&gpu.device, &gpu.queue, options)?,
            craft: CraftLayer::new(&gpu, options)?,
            gpu,
            models: None,
            dated_maps: None,
            sky: None,
            tracks: None,
            captions: None,
            shown,
            hides_sky: false,
            adaptation: (options.exposure == Exposure::Auto).then(Adaptation::default),
            shot: 0,
            frame: 0,
            has_user_exposure: false,
            keeps_star_gain: false,
        })
    }

    /// The same with all layers of a flight's scene.
    pub fn of(
        flight: &Flight,
        gpu: GpuContext,
        options: &EarthOptions,
        shown: wgpu::TextureFormat,
    ) -> Result<Self, PlayError> {
        Self::of_scene(flight.scene(), flight, gpu, options, shown)
    }

    /// The same of another scene with the same flight and the same dated maps.
    pub fn of_scene(
        scene: &Scene,
        flight: &Flight,
        gpu: GpuContext,
        options: &EarthOptions,
        shown: wgpu::TextureFormat,
    ) -> Result<Self, PlayError> {
        let mut painter = Self::new(gpu, options, shown)?;
        painter.show_dated_maps(flight)?;
        painter.show_models(flight)?;
        let (gpu, earth) = (&painter.gpu, &painter.earth);
        painter.sky = SkyLayer::of_scene(scene, flight, gpu, earth)?;
        painter.tracks = TracksLayer::of_scene(scene, flight, gpu, earth, shown)?;
        painter.show_captions(flight)?;
        Ok(painter)
    }

    /// Adapter, device and queue.
    pub fn gpu(&self) -> &GpuContext {
        &self.gpu
    }

    pub fn earth(&self) -> &Earth {
        &self.earth
    }

    /// Draws the maps of each picture's date from now on, where they change with it; without, those that it was opened with.
    pub fn show_dated_maps(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.dated_maps = DatedMapsLayer::of(flight, &self.gpu)?;
        Ok(())
    }

    /// Draws the models of a flight's satellites from now on, where its scene names any.
    pub fn show_models(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.models = ModelLayer::of(flight, &self.gpu, &self.earth)?;
        Ok(())
    }

    /// Draws what is beyond the Earth from now on, where a flight's scene asks for any of it.
    pub fn show_sky(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.show_sky_of(flight.scene().clone(), flight)
    }

    /// Has the sky that is shown from now on keep the gain of its stars where the picture shows daylight.
    pub fn keep_star_gain(&mut self) {
        self.keeps_star_gain = true;
    }

    /// The same without one part of it, by its key; without "aperture" the Sun has no spikes, without "ghosts" none of them.
    pub fn show_sky_without(&mut self, flight: &Flight, part: &str) -> Result<(), PlayError> {
        let mut scene = flight.scene().clone();
        match part {
            "aperture" => scene.aperture = None,
            "ghosts" => scene.ghosts = None,
            part => scene.sky.switch_off(part),
        }
        self.show_sky_of(scene, flight)
    }

    fn show_sky_of(&mut self, mut scene: Scene, flight: &Flight) -> Result<(), PlayError> {
        scene.sky.stars_fade_by_day &= !self.keeps_star_gain;
        self.sky = SkyLayer::of_scene(&scene, flight, &self.gpu, &self.earth)?;
        Ok(())
    }

    /// Draws the tracks of a flight's satellites from now on, where its scene asks for any.
    pub fn show_tracks(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.tracks = TracksLayer::of(flight, &self.gpu, &self.earth, self.shown)?;
        Ok(())
    }

    /// Writes the captions of a flight's scene over pictures from now on, where it has any.
    pub fn show_captions(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.captions = CaptionLayer::of(flight, &self.gpu, self.shown)?;
        Ok(())
    }

    /// The places in the scene of the satellites whose dots are seen within so many pixels of one, of the picture as it was drawn.
    #[cfg(feature = "window")]
    pub fn markers_near(&self, at_px: [f32; 2], within_px: f32) -> impl Iterator<Item = usize> {
        let tracks = self.tracks.iter().filter(|tracks| tracks.is_shown());
        tracks.flat_map(move |tracks| tracks.markers_near(at_px, within_px))
    }

    /// Whether models of satellites are drawn.
    #[cfg(feature = "window")]
    pub fn has_models(&self) -> bool {
        self.models.is_some()
    }

    /// Draws the layers of a scene of the same flight beside the Earth from now on, those alone that are to be shown. What is missing is
    /// made; what is hidden stays loaded.
    ///
    /// # Errors
    /// As [`Self::of`]; the layers made before the error stay.
    pub(crate) fn show_layers(
        &mut self,
        scene: &Scene,
        flight: &Flight,
        shows_sky: bool,
        tracks: ShownTracks,
    ) -> Result<(), PlayError> {
        let (gpu, earth) = (&self.gpu, &self.earth);
        self.hides_sky = !shows_sky;
        if shows_sky && self.sky.is_none() {
            self.sky = SkyLayer::of_scene(scene, flight, gpu, earth)?;
        }
        let has_tracks = |layer: &TracksLayer| layer.has_tracks_of(scene);
        if !self.tracks.as_ref().is_some_and(has_tracks) {
            self.tracks = TracksLayer::of_scene(scene, flight, gpu, earth, self.shown)?;
        }
        if let Some(layer) = &mut self.tracks {
            layer.show(scene, flight, tracks)?;
        }
        if let Some(captions) = &mut self.captions {
            captions.show_legend(coverage_legend(scene, flight)?);
        }
        Ok(())
    }

    /// Shows sky, satellites and stations from now on, or hides them. All that is needed is there.
    ///
    /// # Errors
    /// As [`Self::of`].
    #[cfg(feature = "window")]
    pub(crate) fn show_parts(
        &mut self,
        shows_sky: bool,
        tracks: ShownTracks,
    ) -> Result<(), PlayError> {
        self.hides_sky = !shows_sky;
        match &mut self.tracks {
            Some(layer) => layer.show_parts(tracks),
            None => Ok(()),
        }
    }

    /// Has captions leave so much of the picture to the panel, on the left and at the bottom, pixels.
    #[cfg(feature = "window")]
    pub fn leave_to_panel(&mut self, covered_px: [f32; 2]) {
        if let Some(captions) = &mut self.captions {
            captions.leave_to_panel(covered_px);
        }
    }

    /// Whether the sky is loaded.
    #[cfg(feature = "window")]
    pub fn has_sky(&self) -> bool {
        self.sky.is_some()
    }

    /// Whether it has what a scene of the same flight shows of satellites.
    #[cfg(feature = "window")]
    pub fn has_tracks_of(&self, scene: &Scene) -> bool {
        match &self.tracks {
            Some(layer) => layer.has_tracks_of(scene),
            None => scene.orbits.iter().all(|orbit| orbit.track.is_off()),
        }
    }

    /// Draws these tracks from now on, and this legend.
    #[cfg(feature = "window")]
    pub(crate) fn adopt_tracks(
        &mut self,
        tracks: Option<TracksLayer>,
        legend: Option<CoverageLegend>,
    ) {
        self.tracks = tracks;
        if let Some(captions) = &mut self.captions {
            captions.show_legend(legend);
        }
    }

    /// Goes on with the exposure that another one has followed.
    #[cfg(feature = "window")]
    pub fn go_on_from(&mut self, before: Self) {
        if let (Some(own), Some(adaptation)) = (&mut self.adaptation, before.adaptation) {
            (*own, self.shot) = (adaptation, before.shot);
        }
    }

    /// Draws the Earth better or worse from now on. The other layers follow by [`Self::follow_quality`].
    pub fn set_quality(&mut self, quality: &Quality) -> Result<(), EarthError> {
        self.earth.set_quality(&self.gpu.queue, quality)
    }

    /// Draws all else with the samples of the Earth. What cannot is drawn no longer, and is answered: what it is, with its verb, and why.
    pub fn follow_quality(&mut self) -> Vec<(&'static str, PlayError)> {
        self.craft.set_samples(self.earth.quality().samples);
        if let Some(models) = &mut self.models {
            models.set_samples(self.earth.quality().samples);
        }
        let mut lost = Vec::new();
        if let Some(sky) = &mut self.sky
            && let Err(error) = sky.follow(&self.gpu, &self.earth)
        {
            lost.push(("the sky is", error));
            self.sky = None;
        }
        if let Some(tracks) = &mut self.tracks
            && let Err(error) = tracks.follow(&self.earth)
        {
            lost.push(("tracks are", error));
            self.tracks = None;
        }
        lost
    }

    /// Whether pictures are exposed as what is in view asks for.
    pub fn meters_exposure(&self) -> bool {
        self.adaptation.is_some()
    }

    /// Exposes the next pictures so, those apart that have an exposure of their own ([`Moment::exposure_ev`]).
    ///
    /// # Errors
    /// An exposure value out of [`Exposure::RANGE_EV`].
    pub fn set_exposure(&mut self, exposure: Exposure) -> Result<(), EarthError> {
        self.earth.set_exposure(exposure)
    }

    /// Exposes all pictures so from now on, those that have an exposure of their own among them; `None` as the scene of `usual` does.
    ///
    /// # Errors
    /// As [`Self::set_exposure`].
    pub fn choose_exposure(
        &mut self,
        chosen: Option<Exposure>,
        usual: Exposure,
    ) -> Result<(), EarthError> {
        let exposure = chosen.unwrap_or(usual);
        self.earth.set_exposure(exposure)?;
        self.has_user_exposure = chosen.is_some();
        self.adaptation = match exposure {
            Exposure::Auto => Some(self.adaptation.take().unwrap_or_default()),
            Exposure::Ev(_) => None,
        };
        Ok(())
    }

    /// Where exposure is metered, adapts that of the next image to its view over the time since the last one, seconds; after a cut, at once.
    /// Returns the exposure value, where one is metered.
    pub fn follow_light(
        &mut self,
        moment: &Moment,
        elapsed_s: f64,
    ) -> Result<Option<f64>, EarthError> {
        let Some(adaptation) = &mut self.adaptation else {
            return Ok(None);
        };
        let Some(metered_ev) = self.earth.metered_ev(&moment.view, &moment.sky) else {
            return Ok(None);
        };
        let is_cut = std::mem::replace(&mut self.shot, moment.shot) != moment.shot;
        let elapsed_s = if is_cut { f64::INFINITY } else { elapsed_s };
        let ev = adaptation.follow(metered_ev, elapsed_s);
        self.earth.set_exposure(Exposure::Ev(ev))?;
        Ok(Some(ev))
    }

    /// Says where the eye will be soon, so that tiles are there when it comes.
    pub fn prefetch(&mut self, views: &[EyeView]) {
        self.earth.prefetch(views);
    }

    /// Prepares an instant at a size in pixels. Answers the tiles that are missing, if it waited for them.
    pub fn prepare(
        &mut self,
        moment: &Moment,
        drawn_size: (u32, u32),
        patience: Patience,
    ) -> (FrameStats, Vec<TileKey>) {
        self.expose(moment);
        self.frame = moment.frame;
        let (wait, detail) = match patience {
            Patience::Live => (None, TrackDetail::Live),
            Patience::WholeTracks => (None, TrackDetail::Complete),
            Patience::Complete(wait) => (Some(wait), TrackDetail::Complete),
        };
        if let Some(maps) = &mut self.dated_maps {
            let wait = wait.unwrap_or_default();
            maps.prepare(&self.gpu, &mut self.earth, moment.epoch, wait);
        }
        let (queue, view, sky) = (&self.gpu.queue, &moment.view, &moment.sky);
        let (mut stats, missing) = match wait {
            None => (
                self.earth
                    .prepare(queue, FrameRequest::new(view, sky, drawn_size)),
                Vec::new(),
            ),
            Some(wait) => {
                self.earth
                    .prepare_complete(queue, FrameRequest::new(view, sky, drawn_size), wait)
            }
        };
        let has_own = self.models.as_ref().is_some_and(ModelLayer::has_followed);
        let craft = moment.craft.as_ref().filter(|_| !has_own);
        self.craft.prepare(&self.gpu, craft, view, sky, &mut stats);
        if let Some(models) = &mut self.models {
            models.prepare(&self.gpu, &self.earth, moment, drawn_size, &mut stats);
        }
        if let Some(sky) = self.sky.as_mut().filter(|_| !self.hides_sky) {
            sky.prepare(&self.gpu, &self.earth, moment, drawn_size, &mut stats);
        }
        if let Some(tracks) = self.tracks.as_mut().filter(|tracks| tracks.is_shown()) {
            tracks.prepare(&self.gpu, moment, drawn_size, detail, &mut stats);
        }
        if let Some(captions) = &mut self.captions {
            captions.prepare(moment, &stats);
        }
        (stats, missing)
    }

    /// Takes the exposure that the moment has of its own.
    fn expose(&mut self, moment: &Moment) {
        if let Some(ev) = moment.exposure_ev.filter(|_| !self.has_user_exposure)
            // Keys lie in the range, and what is between them too.
            && let Err(error) = self.earth.set_exposure(Exposure::Ev(ev))
        {
            tracing::warn!("the exposure is unchanged: {error}");
        }
    }

    /// Draws what was prepared, with the names of tracks and captions over the finished picture.
    pub fn paint(&mut self, encoder: &mut wgpu::CommandEncoder, target: &impl PictureTarget) {
        let mut pass = target.begin_pass(encoder);
        self.render_surface(&mut pass);
        self.render_air(&mut pass);
        self.render_beyond(&mut pass);
        drop(pass);
        target.set_frame(&self.gpu.queue, self.frame);
        target.finish(encoder);
        if let Some(tracks) = self.tracks.as_mut().filter(|tracks| tracks.is_shown()) {
            let (size, drawn_size) = (target.size(), target.drawn_size());
            tracks.write_names(&self.gpu, encoder, target.view(), size, drawn_size);
        }
        if let Some(captions) = &mut self.captions {
            captions.draw(EguiTarget {
                device: &self.gpu.device,
                queue: &self.gpu.queue,
                encoder,
                view: target.view(),
                size: target.size(),
            });
        }
    }

    /// Draws the craft and the ground: the first part of a picture, so that the air lies behind the craft.
    pub fn render_surface(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.craft.render(pass);
        if let Some(models) = &self.models {
            models.render(pass);
        }
        self.earth.render_surface(pass);
    }

    /// Draws the air, which follows.
    pub fn render_air(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.earth.render_air(pass);
    }

    /// Draws what is beyond the Earth, clouds before it, what of models is seen through, and tracks, which come last.
    pub fn render_beyond(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(sky) = self.sky.as_ref().filter(|_| !self.hides_sky) {
            sky.render(pass);
        }
        self.earth.render_clouds_overhead(pass);
        if let Some(models) = &self.models {
            models.render_blended(pass);
        }
        if let Some(tracks) = self.tracks.as_ref().filter(|tracks| tracks.is_shown()) {
            tracks.render(pass);
        }
    }

    /// Whether the picture still waits for maps of its date, or for tracks to be whole.
    #[cfg(feature = "window")]
    pub fn is_loading(&self) -> bool {
        let is_growing = |tracks: &TracksLayer| !tracks.is_complete();
        let tracks = self.tracks.as_ref().filter(|tracks| tracks.is_shown());
        tracks.is_some_and(is_growing)
            || self
                .dated_maps
                .as_ref()
                .is_some_and(DatedMapsLayer::is_loading)
    }

    /// Bytes of the WGSL that the driver got, of the Earth and of what is beside it.
    pub fn shader_bytes(&self) -> u64 {
        let tracks = self.tracks.as_ref().map_or(0, TracksLayer::shader_bytes);
        let sky = self.sky.as_ref();
        let sky = sky.map_or(0, |sky| sky.celestial().shader_bytes());
        let models = self.models.as_ref().map_or(0, ModelLayer::shader_bytes);
        self.earth.diagnostics().shader_bytes + sky + tracks + models
    }

    /// Names of what is drawn beyond the Earth, and of what is not.
    pub fn sky_features(&self) -> [Vec<&'static str>; 2] {
        let options = self.sky.as_ref().map(|sky| sky.celestial().options());
        let on = options.map_or_else(Vec::new, CelestialOptions::features_on);
        let off = CelestialOptions::FEATURES.into_iter();
        [on.clone(), off.filter(|name| !on.contains(name)).collect()]
    }
}
