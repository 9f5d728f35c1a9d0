//! Layers, exposure and tone curve that the user switches during display.

use super::error::PlayError;
use super::map_lines::dropped_lines;
use super::maps::dropped_layers;
use super::place_text::place_text;
use crate::scene::{Orbit, Scene, StationTable, ToneTable, Track};
use std::path::Path;
use terrella::frames::Geodetic;
use terrella::{Exposure, Quality, QualityReduction, Tone};
use terrella_imagery::tile::MapLayer;

/// All layers that are off in most scenes, with their default style.
const USUAL: &str = "[tracks]\ntrail = true\nground_track = true\nmarker = true\n\
                     [layers]\ngraticule = true\ncoast_lines = true\nborders = true\nterminator = true\nmoon_shadow = true\nplace_names = true\n";

/// The scene's own response, which no other can be chosen in place of.
pub const MEASURED: &str = "measured";

/// A curve as scenes write it.
pub fn tone_name(tone: Tone) -> &'static str {
    match tone {
        Tone::Camera => "camera",
        Tone::Neutral => "neutral",
        Tone::Linear => "linear",
        Tone::Filmic => "filmic",
        Tone::Agx => "agx",
        Tone::Measured(_) => MEASURED,
    }
}

/// The place that passes are over, which is drawn as a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Site {
    pub place: Geodetic,
    /// Degrees.
    pub min_elevation_deg: f64,
}

/// A layer that is switched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    Clouds,
    CityLights,
    Atmosphere,
    /// Stars, Milky Way, Sun and Moon.
    Sky,
    Graticule,
    CoastLines,
    Borders,
    Terminator,
    /// Outlines of umbra and penumbra.
    MoonShadow,
    /// Names of cities.
    PlaceNames,
    /// Trails, ground tracks, footprints and markers.
    Tracks,
    Stations,
    /// Files of GeoJSON.
    Files,
    /// The map of coverage.
    Coverage,
}

impl Layer {
    /// All of them, in the panel's order.
    pub const ALL: [Self; 14] = [
        Self::Clouds,
        Self::CityLights,
        Self::Atmosphere,
        Self::Sky,
        Self::Graticule,
        Self::CoastLines,
        Self::Borders,
        Self::Terminator,
        Self::MoonShadow,
        Self::PlaceNames,
        Self::Tracks,
        Self::Stations,
        Self::Files,
        Self::Coverage,
    ];

    /// Its name in the panel.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clouds => "clouds",
            Self::CityLights => "city lights",
            Self::Atmosphere => "atmosphere",
            Self::Sky => "stars, Sun, Moon",
            Self::Graticule => "graticule",
            Self::CoastLines => "coast lines",
            Self::Borders => "borders",
            Self::Terminator => "terminator",
            Self::MoonShadow => "Moon's shadow",
            Self::PlaceNames => "place names",
            Self::Tracks => "tracks",
            Self::Stations => "stations",
            Self::Files => "GeoJSON",
            Self::Coverage => "coverage",
        }
    }

    /// The key of a scene whose file it is drawn from, with its table.
    fn key(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Clouds => Some(("earth", "clouds")),
            Self::CityLights => Some(("earth", "night_lights")),
            Self::CoastLines => Some(("layers", "coast_lines")),
            Self::Borders => Some(("layers", "borders")),
            Self::PlaceNames => Some(("layers", "place_names")),
            _ => None,
        }
    }
}

/// Layers as set by the user.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Switches {
    is_on: [bool; Layer::ALL.len()],
    /// Whether the scene has any of the layer.
    is_offered: [bool; Layer::ALL.len()],
    /// `None` is the scene's.
    pub exposure: Option<Exposure>,
    pub tone: Option<Tone>,
    /// Drawn besides the scene's stations.
    site: Option<Site>,
}

impl Switches {
    /// The initial state from a scene.
    pub fn of(scene: &Scene) -> Self {
        let (earth, layers) = (&scene.earth, &scene.layers);
        let has_satellites = !scene.orbits.is_empty();
        // Tracks of a simulation need no key.
        let has_tracks = |orbit: &Orbit| !orbit.track.is_off() || orbit.basilisk.is_some();
        let is_on = Layer::ALL.map(|layer| match layer {
            Layer::Clouds => earth.clouds,
            Layer::CityLights => earth.night_lights,
            Layer::Atmosphere => earth.has_air(),
            Layer::Sky => scene.sky.is_on(),
            Layer::Graticule => layers.graticule.is_some(),
            Layer::CoastLines => layers.coast_lines.is_some(),
            Layer::Borders => layers.borders.is_some(),
            Layer::Terminator => layers.terminator.is_some(),
            Layer::MoonShadow => layers.moon_shadow.is_some(),
            Layer::PlaceNames => layers.place_names.is_some(),
            Layer::Tracks => scene.orbits.iter().any(has_tracks),
            Layer::Stations => !scene.stations.is_empty(),
            Layer::Files => !scene.geojson.is_empty(),
            Layer::Coverage => scene.coverage.is_some(),
        });
        let is_offered = Layer::ALL.map(|layer| match layer {
            Layer::CityLights => !earth.is_paper(),
            Layer::Tracks => has_satellites,
            Layer::Stations => !scene.stations.is_empty(),
            Layer::Files => !scene.geojson.is_empty(),
            Layer::Coverage => scene.coverage.is_some(),
            _ => true,
        });
        Self {
            is_on,
            is_offered,
            exposure: None,
            tone: match scene.output.tone {
                ToneTable::Named(tone) => Some(tone),
                ToneTable::Measured { .. } => None,
            },
            site: None,
        }
    }

    /// The same with this place of passes.
    pub fn at(mut self, site: Option<Site>) -> Self {
        self.set_site(site);
        self
    }

    /// The place that passes are over.
    pub fn site(&self) -> Option<Site> {
        self.site
    }

    /// Sets the place of passes. A new place switches stations on.
    pub fn set_site(&mut self, site: Option<Site>) {
        let place = |site: Option<Site>| site.map(|site| site.place);
        let is_on = &mut self.is_on[Layer::Stations as usize];
        match site {
            Some(_) if place(site) != place(self.site) => *is_on = true,
            Some(_) => {}
            None => *is_on &= self.is_offered[Layer::Stations as usize],
        }
        self.site = site;
    }

    /// The same with this exposure.
    pub fn exposed(self, exposure: Option<Exposure>) -> Self {
        Self { exposure, ..self }
    }

    pub fn is_on(&self, layer: Layer) -> bool {
        self.is_on[layer as usize]
    }

    /// Whether there is any of this layer.
    pub fn is_offered(&self, layer: Layer) -> bool {
        self.is_offered[layer as usize] || layer == Layer::Stations && self.site.is_some()
    }

    /// Switches a layer that is offered.
    pub fn toggle(&mut self, layer: Layer) {
        self.is_on[layer as usize] ^= self.is_offered(layer);
    }

    pub fn next_tone(&mut self) {
        let present = Tone::ALL.iter().position(|tone| Some(*tone) == self.tone);
        let next = present.map_or(0, |index| (index + 1) % Tone::ALL.len());
        self.tone = Some(Tone::ALL[next]);
    }

    /// The scene with everything that must be loaded or created: layers that are off in `base` are included as if their key were `true`. Disabled
    /// parts of `[layers]` are removed; other disabled layers stay, since they are loaded and only hidden.
    ///
    /// # Errors
    /// A layer whose file is missing, as in a strict scene.
    pub fn scene(&self, base: &Scene) -> Result<Scene, PlayError> {
        let usual = Scene::from_toml(USUAL, Path::new("switched on"))?;
        let mut scene = base.clone();
        let lines = &mut scene.layers;
        for (layer, line, usual) in [
            (
                Layer::CoastLines,
                &mut lines.coast_lines,
                usual.layers.coast_lines,
            ),
            (Layer::Borders, &mut lines.borders, usual.layers.borders),
            (
                Layer::Terminator,
                &mut lines.terminator,
                usual.layers.terminator,
            ),
            (
                Layer::MoonShadow,
                &mut lines.moon_shadow,
                usual.layers.moon_shadow,
            ),
        ] {
            *line = line.or(usual).filter(|_| self.is_on(layer));
        }
        let names = lines.place_names.or(usual.layers.place_names);
        lines.place_names = names.filter(|_| self.is_on(Layer::PlaceNames));
        let graticule = lines.graticule.or(usual.layers.graticule);
        lines.graticule = graticule.filter(|_| self.is_on(Layer::Graticule));
        if self.is_on(Layer::Sky) && !scene.sky.is_on() {
            let [stars, milky_way, sun, moon, glare] = usual.sky.parts().map(|(_, is_on)| is_on);
            let sky = &mut scene.sky;
            (sky.stars, sky.milky_way, sky.sun) = (stars, milky_way, sun);
            (sky.moon, sky.glare) = (moon, glare);
        }
        let has_tracks = scene.orbits.iter().any(|orbit| !orbit.track.is_off());
        if let Some(usual) = usual.orbits.first()
            && self.is_on(Layer::Tracks)
            && !has_tracks
        {
            for orbit in &mut scene.orbits {
                let color = orbit.track.color;
                orbit.track = Track {
                    color,
                    ..usual.track
                };
            }
        }
        if !self.is_on(Layer::Files) {
            scene.geojson.clear();
        }
        if let Some(site) = &self.site {
            let is_own = |one: &StationTable| one.place == site.place;
            if !scene.stations.iter().any(is_own) {
                scene.stations.push(StationTable {
                    name: place_text(site.place.lat_rad, site.place.lon_rad),
                    place: site.place,
                    min_elevation_deg: site.min_elevation_deg,
                    color: None,
                });
            }
        }
        scene.coverage = scene.coverage.filter(|_| self.is_on(Layer::Coverage));
        scene.earth.clouds |= self.is_on(Layer::Clouds);
        scene.earth.night_lights |= self.is_on(Layer::CityLights);
        if let Some(tone) = self.tone {
            scene.output.tone = ToneTable::Named(tone);
        }
        self.check(base, &scene)?;
        Ok(scene)
    }

    /// Rejects what is switched on and has no file.
    fn check(&self, base: &Scene, scene: &Scene) -> Result<(), PlayError> {
        let before = Self::of(base);
        let is_new = |layer: &Layer| self.is_on(*layer) && !before.is_on(*layer);
        let wanted: Vec<_> = Layer::ALL
            .into_iter()
            .filter(is_new)
            .filter_map(Layer::key)
            .collect();
        if wanted.is_empty() {
            return Ok(());
        }
        let maps = dropped_layers(scene)?.into_iter();
        let maps = maps.map(|dropped| ("earth", dropped, " is missing"));
        let lines = dropped_lines(scene)?.into_iter();
        let lines = lines.map(|dropped| ("layers", dropped, ""));
        for (table, dropped, verb) in maps.chain(lines) {
            if wanted.contains(&(table, dropped.layer)) {
                return Err(PlayError::MissingLayer {
                    scene: base.path.clone(),
                    table,
                    layer: dropped.layer,
                    missing: format!("{}{verb}", dropped.missing),
                });
            }
        }
        Ok(())
    }

    /// Whether a map must be loaded that a scene does not have. Requested maps without a file are not searched again.
    pub fn needs_maps(&self, base: &Scene, loaded: &Quality) -> bool {
        let lacks = |layer: Layer, map: MapLayer, is_loaded: bool| {
            self.is_on(layer) && !is_loaded && !loaded.maps[map.index()]
        };
        let earth = &base.earth;
        lacks(Layer::Clouds, MapLayer::Clouds, earth.clouds)
            || lacks(Layer::CityLights, MapLayer::NightLights, earth.night_lights)
    }

    /// A quality without the layers that are off, and with the air that is on.
    pub fn quality(&self, mut quality: Quality) -> Quality {
        // The one kind of air that there is.
        quality.atmosphere = Default::default();
        for (layer, reduction) in [
            (Layer::Clouds, QualityReduction::Clouds),
            (Layer::CityLights, QualityReduction::Lights),
            (Layer::Atmosphere, QualityReduction::Air),
        ] {
            if !self.is_on(layer) {
                quality = reduction.apply(quality, false);
            }
        }
        quality
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(text: &str) -> Scene {
        let path = Path::new("test.toml");
        Scene::from_toml(text, path).unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn what_is_switched_on_is_as_its_key_alone_draws_it() {
        let base =
            scene("[sky]\nstars = false\nsun = false\nmoon = false\n[earth]\nclouds = false\n");
        let mut switches = Switches::of(&base);
        for layer in Layer::ALL {
            if !switches.is_on(layer) {
                switches.toggle(layer);
            }
        }
        assert!(!switches.is_on(Layer::Stations), "there are none");
        let all = switches.scene(&base).expect("the starter pack has all");
        let written = scene(USUAL);
        assert_eq!(all.layers, written.layers);
        assert_eq!(all.orbits[0].track, written.orbits[0].track);
        assert_eq!(all.sky.parts(), scene("").sky.parts());
        assert!(all.earth.clouds && !base.earth.clouds);
        // All off again: lines are out, what is loaded stays.
        for layer in Layer::ALL {
            switches.toggle(layer);
        }
        let none = switches.scene(&base).expect("nothing to load");
        assert!(!none.layers.is_on());
        assert!(!none.earth.clouds, "it was not loaded for this scene");
    }

    #[test]
    fn lines_of_the_scene_keep_their_look() {
        let base = scene(
            "[layers]\ngraticule = { step_deg = 30 }\nborders = true\nborders_opacity = 0.25\n",
        );
        let mut switches = Switches::of(&base);
        let again = switches.scene(&base).expect("the same");
        assert_eq!(again.layers, base.layers);
        switches.toggle(Layer::Graticule);
        switches.toggle(Layer::Borders);
        assert!(!switches.scene(&base).expect("less").layers.is_on());
        switches.toggle(Layer::Graticule);
        switches.toggle(Layer::Borders);
        assert_eq!(
            switches.scene(&base).expect("as before").layers,
            base.layers
        );
    }

    #[test]
    fn the_place_of_passes_is_a_station_where_the_scene_has_none() {
        let own = "[[station]]\nname = \"A\"\nlat_deg = 1\nlon_deg = 2\n";
        let base = scene(own);
        let mut switches = Switches::of(&base);
        let site = |place| Site {
            place,
            min_elevation_deg: 12.5,
        };
        switches.set_site(Some(site(Geodetic::from_degrees(48.2, 16.4, 0.0))));
        let stations = switches.scene(&base).expect("no files").stations;
        assert_eq!(stations.len(), 2);
        assert_eq!(stations[1].name, "48.200° N, 16.400° E");
        assert_eq!(stations[1].min_elevation_deg, 12.5);
        switches.set_site(Some(site(base.stations[0].place)));
        assert_eq!(
            switches.scene(&base).expect("no files").stations,
            base.stations
        );
    }

    #[test]
    fn the_place_of_passes_is_switched_with_the_stations() {
        let vienna = Site {
            place: Geodetic::from_degrees(48.2, 16.4, 0.0),
            min_elevation_deg: 10.0,
        };
        for own in ["", "[[station]]\nname = \"A\"\nlat_deg = 1\nlon_deg = 2\n"] {
            let mut switches = Switches::of(&scene(own));
            switches.set_site(Some(vienna));
            assert!(switches.is_offered(Layer::Stations) && switches.is_on(Layer::Stations));
            switches.toggle(Layer::Stations);
            // Another elevation at the same place leaves them off, another place does not.
            switches.set_site(Some(Site {
                min_elevation_deg: 5.0,
                ..vienna
            }));
            assert!(!switches.is_on(Layer::Stations), "{own}");
            switches.set_site(Some(Site {
                place: Geodetic::from_degrees(48.3, 16.4, 0.0),
                ..vienna
            }));
            assert!(switches.is_on(Layer::Stations), "{own}");
            assert_eq!(switches.at(None), Switches::of(&scene(own)), "{own}");
        }
    }

    #[test]
    fn a_layer_without_its_file_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        let text = "[earth]\nclouds = false\nnight_lights = false\nwater = false\nnormals = false\ntextures = \".\"\n";
        let path = folder.path().join("a.toml");
        let base = Scene::from_toml(text, &path).expect("a good scene");
        for (layer, key) in [
            (Layer::Clouds, "clouds"),
            (Layer::CityLights, "night_lights"),
        ] {
            let mut switches = Switches::of(&base);
            switches.toggle(layer);
            let error = switches.scene(&base).expect_err("there is no file");
            let said = error.to_string();
            assert!(said.contains(&format!("[earth] {key}: ")), "{said}");
            assert!(said.contains("is missing"), "{said}");
        }
    }

    #[test]
    fn a_map_is_loaded_once() {
        let base = scene("[earth]\nclouds = false\n");
        let mut quality = Quality {
            subdivision: Default::default(),
            anisotropy: 1,
            samples: 1,
            texel_px: 1.0,
            maps: [true; terrella_imagery::tile::MAP_LAYERS],
            atmosphere: Default::default(),
            scale: 1.0,
        };
        quality.maps[MapLayer::Clouds.index()] = false;
        let mut switches = Switches::of(&base);
        assert!(!switches.needs_maps(&base, &quality));
        switches.toggle(Layer::Clouds);
        assert!(switches.needs_maps(&base, &quality));
        quality.maps[MapLayer::Clouds.index()] = true;
        assert!(!switches.needs_maps(&base, &quality));
        assert!(switches.quality(quality).maps[MapLayer::Clouds.index()]);
        switches.toggle(Layer::Clouds);
        switches.toggle(Layer::Atmosphere);
        let less = switches.quality(quality);
        assert!(!less.maps[MapLayer::Clouds.index()]);
        assert_ne!(less.atmosphere, quality.atmosphere);
        // A requested map without a file.
        let default = scene("");
        quality.maps[MapLayer::Clouds.index()] = false;
        assert!(!Switches::of(&default).needs_maps(&default, &quality));
    }
}
