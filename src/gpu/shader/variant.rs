//! What all variants have in common: conditions, a name, a text, a compiled module.

use super::assemble::{ShaderError, ShaderText};
use super::capability::ShaderCapability;

/// What the colour target stores.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum TargetColor {
    /// Linear light; the hardware may encode it.
    Linear,
    /// Display values, which the shader must encode itself.
    Display,
}

impl TargetColor {
    /// Both colour targets.
    pub const ALL: [Self; 2] = [Self::Linear, Self::Display];
}

/// A legal combination of what a shader is made of.
pub trait ShaderVariant: Copy {
    /// The file that lists the others, below `shaders/`.
    const ENTRY: &'static str;

    /// Every legal combination, each once.
    fn all() -> Vec<Self>;

    /// All conditions that its files may ask for, and whether they hold.
    fn conditions(&self) -> Vec<(&'static str, bool)>;

    /// What it needs of a device that not every device has.
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
    pub bytes: u64,
}

impl ShaderModule {
    /// Compiles a variant.
    pub fn new(device: &wgpu::Device, variant: &impl ShaderVariant) -> Result<Self, ShaderError> {
        let source = variant.source()?.text;
        if let Some(folder) = std::env::var_os("TERRELLA_SHADER_DUMP") {
            let path = std::path::Path::new(&folder).join(variant.name() + ".wgsl");
            if let Err(error) = std::fs::write(&path, &source) {
                tracing::warn!("shader not dumped to {}: {error}", path.display());
            }
        }
        let bytes = source.len() as u64;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(&format!("terrella {}", variant.name())),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        Ok(Self { module, bytes })
    }
}

/// Off and on: what a switch of a variant can be.
pub(super) const SWITCH: [bool; 2] = [false, true];
