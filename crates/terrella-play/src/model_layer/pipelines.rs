//! The pipelines of models: one for each way in which a material is drawn, made when it is first drawn.

use super::layouts::ModelLayouts;
use super::uniforms::{ATTRIBUTES, ModelVertex};
use std::collections::HashMap;
use terrella::internals::gpu::{PassFormat, PipelineDescription, ShaderText, TargetColor};
use terrella::{EarthError, GpuContext};
use terrella_model::{AlphaMode, Material};

/// How triangles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ModelVariant {
    pub normal_map: bool,
    /// Laid over what is behind them by their alpha.
    pub blended: bool,
    pub sides: Sides,
}

/// Which sides of triangles are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sides {
    Front,
    Back,
    Both,
}

impl ModelVariant {
    /// The ones that a material is drawn with, one after the other. Of a blended sheet that is seen from both sides the back lies behind.
    pub fn of(material: &Material) -> Vec<Self> {
        let blended = material.alpha == AlphaMode::Blend;
        let one = |sides| Self {
            normal_map: material.normal_texture.is_some(),
            blended,
            sides,
        };
        match (material.double_sided, blended) {
            (true, true) => vec![one(Sides::Back), one(Sides::Front)],
            (true, false) => vec![one(Sides::Both)],
            (false, _) => vec![one(Sides::Front)],
        }
    }

    /// Its shader.
    fn shader(self) -> ModelShader {
        ModelShader {
            normal_map: self.normal_map,
            blended: self.blended,
        }
    }
}

/// A variant of the shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ModelShader {
    pub normal_map: bool,
    pub blended: bool,
}

impl ModelShader {
    /// All of them.
    #[cfg(test)]
    pub fn all() -> [Self; 4] {
        [(false, false), (true, false), (false, true), (true, true)].map(|(normal_map, blended)| {
            Self {
                normal_map,
                blended,
            }
        })
    }

    /// Its text for a pass.
    pub fn text(self, target: TargetColor) -> Result<ShaderText, EarthError> {
        let mut conditions = target.conditions().to_vec();
        conditions.push(("normal_map", self.normal_map));
        conditions.push(("blended", self.blended));
        Ok(ShaderText::assemble("craft_model.wgsl", &conditions)?)
    }
}

/// Shaders and pipelines of a layer.
pub struct ModelPipelines {
    format: PassFormat,
    shaders: HashMap<ModelShader, wgpu::ShaderModule>,
    pipelines: HashMap<ModelVariant, wgpu::RenderPipeline>,
    shader_bytes: u64,
}

impl ModelPipelines {
    /// Compiles the shaders that these need.
    ///
    /// # Errors
    /// A shader that cannot be put together.
    pub fn new(
        gpu: &GpuContext,
        format: PassFormat,
        wanted: impl Iterator<Item = ModelVariant>,
    ) -> Result<Self, EarthError> {
        let mut made = Self {
            format,
            shaders: HashMap::new(),
            pipelines: HashMap::new(),
            shader_bytes: 0,
        };
        for variant in wanted {
            let shader = variant.shader();
            if made.shaders.contains_key(&shader) {
                continue;
            }
            let text = shader.text(format.target_color())?;
            made.shader_bytes += text.text.len() as u64;
            let module = text.compile(&gpu.device, "terrella model")?;
            made.shaders.insert(shader, module);
        }
        Ok(made)
    }

    /// Bytes of the WGSL that the driver got.
    pub fn shader_bytes(&self) -> u64 {
        self.shader_bytes
    }

    /// Follows the pass to another sample count.
    pub fn set_samples(&mut self, samples: u32) {
        if samples != self.format.samples {
            self.format.samples = samples;
            self.pipelines.clear();
        }
    }

    /// Makes the one of a variant, if there is none yet.
    pub fn make(&mut self, gpu: &GpuContext, layouts: &ModelLayouts, variant: ModelVariant) {
        let Some(module) = self.shaders.get(&variant.shader()) else {
            return;
        };
        let format = self.format;
        self.pipelines.entry(variant).or_insert_with(|| {
            PipelineDescription {
                label: "terrella model",
                bind_groups: Some(&[
                    Some(&layouts.frame),
                    Some(layouts.material(variant.normal_map)),
                ]),
                module,
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<ModelVertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &ATTRIBUTES,
                })],
                primitive: wgpu::PrimitiveState {
                    cull_mode: match variant.sides {
                        Sides::Front => Some(wgpu::Face::Back),
                        Sides::Back => Some(wgpu::Face::Front),
                        Sides::Both => None,
                    },
                    ..Default::default()
                },
                format,
                writes_depth: !variant.blended,
                blend: (variant.blended).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
            }
            .create(&gpu.device)
        });
    }

    /// The one of a variant, once it is made.
    pub fn get(&self, variant: ModelVariant) -> Option<&wgpu::RenderPipeline> {
        self.pipelines.get(&variant)
    }
}
