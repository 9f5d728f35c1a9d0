//! What the user switches: shown at once where all is there, else ordered and shown when it is made.

use super::WindowRenderer;
use crate::error::PlayError;
use crate::flight::Flight;
use crate::picture_change::{
    OrderKind, PictureOrder, ReadyKind, ReadyPicture, WholePicture, shown_tracks,
};
use crate::quality_control::QualityControl;
use crate::scene::Scene;
use crate::switches::{Layer, Switches};
use terrella::tracks::TracksOptions;
use terrella::{EarthOptions, Exposure, Tone};

/// What has become of switches.
pub enum Switching {
    /// They are drawn from now on.
    Done,
    /// This is to be made first.
    Ordered(Box<PictureOrder>),
}

impl WindowRenderer {
    /// Exposes so from now on; `None` as the scene says.
    ///
    /// # Errors
    /// An exposure out of range.
    pub fn expose(&mut self, flight: &Flight, exposure: Option<Exposure>) -> Result<(), PlayError> {
        if exposure != self.switches.exposure {
            let usual = flight.scene().output.exposure;
            self.painter.choose_exposure(exposure, usual)?;
            self.switches.exposure = exposure;
        }
        Ok(())
    }

    /// Draws with these layers and this tone curve from now on, where all that they need is there. Else answers what is to be made for
    /// [`Self::adopt`]: nothing is compiled and no file is read in the call.
    ///
    /// # Errors
    /// A layer whose file is missing, and what cannot be drawn; what was drawn then stays as it was.
    pub fn switch(&mut self, flight: &Flight, switches: &Switches) -> Result<Switching, PlayError> {
        let base = flight.scene();
        let scene = switches.scene(base)?;
        let drawn = self.switches.scene(base)?;
        let needs_maps = switches.needs_maps(base, &self.full);
        let tone = scene.output.tone.open()?;
        let has_sky = self.painter.has_sky() || !switches.is_on(Layer::Sky);
        let is_same_earth = switches.quality(self.full) == self.switches.quality(self.full);
        if needs_maps || tone != self.options.tone || !has_sky || !is_same_earth {
            return Ok(self.order_whole(*switches, scene, needs_maps, tone));
        }
        let is_same = scene.layers == drawn.layers
            && scene.geojson == drawn.geojson
            && scene.stations == drawn.stations
            && scene.coverage == drawn.coverage;
        if !is_same || !self.painter.has_tracks_of(&scene) {
            let order = self.order(*switches, scene, self.tracks_of_now());
            return Ok(Switching::Ordered(Box::new(order)));
        }
        let sky = switches.is_on(Layer::Sky);
        self.painter.show_parts(sky, shown_tracks(switches))?;
        self.switches = *switches;
        Ok(Switching::Done)
    }

    /// Has tracks and what stands on the globe made once more.
    ///
    /// # Errors
    /// A layer whose file is missing.
    pub fn order_tracks(
        &self,
        flight: &Flight,
        switches: &Switches,
    ) -> Result<PictureOrder, PlayError> {
        let scene = switches.scene(flight.scene())?;
        Ok(self.order(*switches, scene, self.tracks_of_now()))
    }

    fn tracks_of_now(&self) -> OrderKind {
        OrderKind::Tracks(TracksOptions::of(self.painter.earth()))
    }

    fn order_whole(
        &self,
        switches: Switches,
        scene: Scene,
        needs_maps: bool,
        tone: Tone,
    ) -> Switching {
        let options = (!needs_maps).then(|| EarthOptions {
            tone,
            ..self.options.clone()
        });
        let whole = WholePicture {
            options,
            samples: self.painter.earth().quality().samples,
            size: self.surface.size(),
            drawn_size: self.surface.drawn_size(),
            moment: self.last_moment(),
        };
        let kind = OrderKind::Whole(Box::new(whole));
        Switching::Ordered(Box::new(self.order(switches, scene, kind)))
    }

    fn order(&self, switches: Switches, scene: Scene, what: OrderKind) -> PictureOrder {
        PictureOrder {
            switches,
            scene,
            gpu: self.painter.gpu().clone(),
            format: self.surface.format(),
            what,
        }
    }

    /// What is drawn.
    pub fn switches(&self) -> &Switches {
        &self.switches
    }

    /// Draws what was made from now on, exposed as `now` says.
    ///
    /// # Errors
    /// What cannot be drawn.
    pub fn adopt(
        &mut self,
        flight: &Flight,
        ready: ReadyPicture,
        now: &Switches,
    ) -> Result<(), PlayError> {
        let ReadyPicture {
            switches,
            scene,
            what,
        } = ready;
        match what {
            ReadyKind::Tracks(tracks, legend) => {
                self.painter.adopt_tracks(*tracks, legend);
                let sky = switches.is_on(Layer::Sky);
                self.painter.show_parts(sky, shown_tracks(&switches))?;
                // The Earth may have other samples by now.
                self.set_quality(&self.painter.earth().quality().clone());
            }
            ReadyKind::Whole(made) => {
                let made = *made;
                let before = std::mem::replace(&mut self.painter, made.painter);
                self.painter.go_on_from(before);
                let device = self.painter.gpu().device.clone();
                self.surface.adopt(&device, made.target);
                (self.options, self.full) = (made.options, made.full);
                if let Some(timed) = &mut self.quality_control {
                    let full = switches.quality(self.full);
                    let has_tiles = self.painter.earth().has_tiles();
                    if let Some(control) = QualityControl::of(&scene, full, has_tiles)? {
                        timed.control = control;
                    }
                }
                let usual = flight.scene().output.exposure;
                self.painter.choose_exposure(now.exposure, usual)?;
            }
        }
        self.switches = switches.exposed(now.exposure);
        Ok(())
    }
}
