//! The common part of all variants: conditions, name, text and compiled module.

use super::assemble::ShaderText;
use super::capability::ShaderCapability;
use super::files::ShaderError;
use terrella_ground::light::Tone;

/// Content of the colour target.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TargetColor {
    /// Scene-referred light: a float format. Display values are decoded.
    Radiance,
    /// Light multiplied by the exposure: a float format that is developed after the pass. Display values are stored as the light that the tone
    /// curve maps to them.
    Exposed,
    /// Tone-mapped light, dithered for 8 bits, linear: the hardware encodes it (sRGB formats). Display values are decoded.
    Linear(Tone),
    /// Tone-mapped light as display values, which the shader must encode.
    Display(Tone),
}

impl TargetColor {
    /// The most common ones: together they have every condition except those of other tone curves.
    pub const USUAL: [Self; 4] = [
        Self::Exposed,
        Self::Linear(Tone::Camera),
        Self::Display(Tone::Camera),
        Self::Radiance,
    ];

    /// All of them.
    pub fn all() -> Vec<Self> {
        let shown = |tone| [Self::Linear(tone), Self::Display(tone)];
        let shown = Tone::ALL.into_iter().flat_map(shown);
        let light = [Self::Radiance, Self::Exposed];
        light.into_iter().chain(shown).collect()
    }

    /// The tone curve; `None` if light itself is stored.
    pub fn tone(self) -> Option<Tone> {
        match self {
            Self::Radiance | Self::Exposed => None,
            Self::Linear(tone) | Self::Display(tone) => Some(tone),
        }
    }

    /// The conditions of `common/displayed.wgsl`.
    pub fn conditions(self) -> [(&'static str, bool); 7] {
        let tone = self.tone();
        [
            ("exposed", self == Self::Exposed),
            ("shown", tone.is_some()),
            ("camera", tone == Some(Tone::Camera)),
            ("neutral", tone == Some(Tone::Neutral)),
            ("filmic", tone == Some(Tone::Filmic)),
            ("agx", tone == Some(Tone::Agx)),
            ("encode", matches!(self, Self::Display(_))),
        ]
    }
}

/// A legal combination of shader options.
pub trait ShaderVariant: Copy {
    /// The entry file, below `shaders/`.
    const ENTRY: &'static str;

    /// Every legal combination, each once. Tone curves are independent of the rest and not combined with every part.
    fn all() -> Vec<Self>;

    /// All conditions that its files may use, and whether they hold.
    fn conditions(&self) -> Vec<(&'static str, bool)>;

    /// Capabilities that it needs beyond those of every device.
    fn needs(&self) -> Vec<ShaderCapability> {
        Vec::new()
    }

    /// The conditions that hold.
    fn conditions_met(&self) -> Vec<&'static str> {
        let conditions = self.conditions().into_iter();
        conditions
            .filter_map(|(name, on)| on.then_some(name))
            .collect()
    }

    /// A name for labels and dumps: `earth+blocks+sunlit+clouds`. No two variants have the same.
    fn name(&self) -> String {
        let mut name = Self::ENTRY.trim_end_matches(".wgsl").to_owned();
        for condition in self.conditions_met() {
            name = name + "+" + condition;
        }
        name
    }

    /// The WGSL that the driver gets.
    fn source(&self) -> Result<ShaderText, ShaderError> {
        ShaderText::assemble(Self::ENTRY, &self.conditions())
    }
}

/// A compiled variant.
pub(crate) struct ShaderModule {
    pub module: wgpu::ShaderModule,
    /// Length of its text.
    #[cfg(feature = "tracks")]
    pub bytes: u64,
}

impl ShaderModule {
    /// Compiles a variant.
    pub fn new(device: &wgpu::Device, variant: &impl ShaderVariant) -> Result<Self, ShaderError> {
        let source = variant.source()?;
        if let Some(folder) = std::env::var_os("TERRELLA_SHADER_DUMP") {
            let path = std::path::Path::new(&folder).join(variant.name() + ".wgsl");
            if let Err(error) = std::fs::write(&path, &source.text) {
                tracing::warn!("shader not dumped to {}: {error}", path.display());
            }
        }
        Ok(Self {
            module: source.compile(device, &format!("terrella {}", variant.name()))?,
            #[cfg(feature = "tracks")]
            bytes: source.text.len() as u64,
        })
    }
}

/// Off and on: what a switch of a variant can be.
pub(super) const SWITCH: [bool; 2] = [false, true];
