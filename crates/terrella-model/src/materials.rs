//! Metallic-roughness materials with their textures and pictures (specification, section 3.9).

use super::container::Container;
use super::error::{ModelError, ModelFault};
use super::json::{self, TextureInfo};
use super::{MAX_SIDE, MAX_TEXELS};
use glam::{Vec3, Vec4};
use std::collections::{BTreeSet, HashMap};
use terrella_files::cause;
use terrella_imagery::decode_rgba;

/// Material of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Linear red, green, blue and alpha, 0…1; multiplies the texture.
    pub base_color: Vec4,
    /// Texels are sRGB.
    pub base_color_texture: Option<TextureUse>,
    /// 0…1; multiplies the blue of the texture.
    pub metallic: f32,
    /// Perceptual roughness, 0…1; multiplies the green of the texture.
    pub roughness: f32,
    /// Texels are linear.
    pub metallic_roughness_texture: Option<TextureUse>,
    /// Linear light that the surface gives by itself; 1 is a white diffuse sheet that faces the Sun. Multiplies the texture.
    pub emissive: Vec3,
    /// Texels are sRGB.
    pub emissive_texture: Option<TextureUse>,
    /// Whether both sides of a triangle are visible.
    pub double_sided: bool,
    /// What alpha does.
    pub alpha: AlphaMode,
    /// Texels are linear: directions in the axes of tangent, bitangent and normal, 0…1 for −1…1.
    pub normal_texture: Option<TextureUse>,
    /// Multiplies the directions along tangent and bitangent.
    pub normal_scale: f32,
}

/// What the alpha of a material does (specification, section 3.9.4).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum AlphaMode {
    /// Nothing.
    #[default]
    Opaque,
    /// Below this alpha nothing is drawn.
    Mask(f32),
    /// It is the part that the surface covers of what is behind it.
    Blend,
}

impl Default for Material {
    /// The default material of the format, section 3.9.6.
    fn default() -> Self {
        Self {
            base_color: Vec4::ONE,
            base_color_texture: None,
            metallic: 1.0,
            roughness: 1.0,
            metallic_roughness_texture: None,
            emissive: Vec3::ZERO,
            emissive_texture: None,
            double_sided: false,
            alpha: AlphaMode::Opaque,
            normal_texture: None,
            normal_scale: 1.0,
        }
    }
}

/// A picture laid on a surface by its first texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TextureUse {
    /// Its place in [`Model::images`](super::Model::images).
    pub image: usize,
    /// Wrapping beyond its sides, across and down.
    pub wrap: [Wrap; 2],
}

/// Wrapping of a texture beyond its side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The picture again.
    #[default]
    Repeat,
    /// The picture mirrored.
    Mirror,
    /// Its last texel.
    Clamp,
}

/// A decoded picture.
#[derive(Clone, PartialEq, Eq)]
pub struct ModelImage {
    /// Width and height, texels.
    pub size: (u32, u32),
    /// Four bytes a texel, rows from the top.
    pub rgba: Vec<u8>,
}

impl std::fmt::Debug for ModelImage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (width, height) = self.size;
        write!(f, "ModelImage({width} × {height})")
    }
}

#[derive(Default)]
pub struct Looks {
    pub materials: Vec<Material>,
    pub images: Vec<ModelImage>,
}

/// Reads the materials that are used, and no others.
pub fn read(
    container: &Container,
    used: &[Option<u64>],
    ignored: &mut BTreeSet<String>,
) -> Result<Looks, ModelError> {
    let mut reader = Reader {
        container,
        images: Vec::new(),
        places: HashMap::new(),
        texels: 0,
        ignored,
    };
    let materials = used.iter().map(|index| match index {
        None => Ok(Material::default()),
        Some(index) => reader.material(*index),
    });
    Ok(Looks {
        materials: materials.collect::<Result<_, _>>()?,
        images: reader.images,
    })
}

struct Reader<'c, 'i> {
    container: &'c Container,
    images: Vec<ModelImage>,
    /// By index in the document.
    places: HashMap<u64, usize>,
    texels: u64,
    ignored: &'i mut BTreeSet<String>,
}

impl Reader<'_, '_> {
    fn material(&mut self, index: u64) -> Result<Material, ModelError> {
        let container = self.container;
        let materials = &container.document.materials;
        let pointer = format!("/materials/{index}");
        let material = container.object(materials, "material", index, &pointer)?;
        self.note_ignored(material);
        let standard = json::MetallicRoughness::default();
        let surface = material.pbr_metallic_roughness.as_ref();
        let surface = surface.unwrap_or(&standard);
        let part = |value: Option<f64>| value.unwrap_or(1.0).clamp(0.0, 1.0) as f32;
        let strength = material.extensions.emissive_strength.as_ref();
        let strength = strength.and_then(|one| one.emissive_strength);
        let emissive = material.emissive_factor.unwrap_or_default();
        let emissive = emissive.map(|x| (x.clamp(0.0, 1.0) * strength.unwrap_or(1.0)) as f32);
        let emissive = Vec3::from_array(emissive);
        if !emissive.is_finite() || emissive.min_element() < 0.0 {
            let expected = "a number of at least 0";
            let text = format!("{:?}", strength.unwrap_or(1.0));
            return Err(container.wrong("emissiveStrength", text, expected, &pointer));
        }
        let normal = material.normal_texture.as_ref();
        let base_color = surface.base_color_factor.unwrap_or([1.0; 4]);
        Ok(Material {
            base_color: Vec4::from_array(base_color.map(|x| x.clamp(0.0, 1.0) as f32)),
            base_color_texture: self.texture(surface.base_color_texture.as_ref(), &pointer)?,
            metallic: part(surface.metallic_factor),
            roughness: part(surface.roughness_factor),
            metallic_roughness_texture: self
                .texture(surface.metallic_roughness_texture.as_ref(), &pointer)?,
            emissive,
            emissive_texture: match emissive == Vec3::ZERO {
                true => None,
                false => self.texture(material.emissive_texture.as_ref(), &pointer)?,
            },
            double_sided: material.double_sided,
            alpha: match material.alpha_mode.as_deref() {
                Some("MASK") => AlphaMode::Mask(material.alpha_cutoff.unwrap_or(0.5) as f32),
                Some("BLEND") => AlphaMode::Blend,
                _ => AlphaMode::Opaque,
            },
            normal_texture: self.texture(normal, &pointer)?,
            normal_scale: match normal.and_then(|info| info.scale) {
                None => 1.0,
                Some(scale) if (scale as f32).is_finite() => scale as f32,
                Some(scale) => {
                    let expected = "a finite number";
                    return Err(container.wrong("scale", scale.to_string(), expected, &pointer));
                }
            },
        })
    }

    fn note_ignored(&mut self, material: &json::Material) {
        if material.occlusion_texture.is_some() {
            self.ignored.insert("occlusionTexture".to_owned());
        }
    }

    fn texture(
        &mut self,
        info: Option<&TextureInfo>,
        pointer: &str,
    ) -> Result<Option<TextureUse>, ModelError> {
        let Some(info) = info else {
            return Ok(None);
        };
        if info.tex_coord != 0 {
            self.ignored
                .insert("textures by texture coordinates other than TEXCOORD_0".to_owned());
            return Ok(None);
        }
        let container = self.container;
        let document = &container.document;
        let texture = container.object(&document.textures, "texture", info.index, pointer)?;
        let pointer = format!("/textures/{}", info.index);
        let Some(source) = texture.source else {
            // By an extension that is not required, such as WebP.
            self.ignored.insert("textures without source".to_owned());
            return Ok(None);
        };
        let wrap = match texture.sampler {
            None => [Wrap::Repeat; 2],
            Some(index) => {
                let sampler = container.object(&document.samplers, "sampler", index, &pointer)?;
                [sampler.wrap_s, sampler.wrap_t].map(|wrap| match wrap {
                    Some(33_071) => Wrap::Clamp,
                    Some(33_648) => Wrap::Mirror,
                    _ => Wrap::Repeat,
                })
            }
        };
        let image = match self.places.get(&source) {
            Some(image) => *image,
            None => {
                let image = self.image(source, &pointer)?;
                self.images.push(image);
                self.places.insert(source, self.images.len() - 1);
                self.images.len() - 1
            }
        };
        Ok(Some(TextureUse { image, wrap }))
    }

    fn image(&mut self, index: u64, pointer: &str) -> Result<ModelImage, ModelError> {
        let container = self.container;
        let image = container.object(&container.document.images, "image", index, pointer)?;
        let pointer = format!("/images/{index}");
        let read;
        let contents = match (&image.uri, image.buffer_view) {
            (Some(uri), _) => {
                read = container.resource(uri, &pointer)?;
                read.as_slice()
            }
            (None, Some(view)) => container.view(view, 0, &pointer)?,
            (None, None) => {
                let missing = ModelFault::Missing("uri and no bufferView");
                return Err(container.error(missing, pointer));
            }
        };
        let texels = &mut self.texels;
        let accept = |width: u32, height: u32| {
            *texels += u64::from(width) * u64::from(height);
            if width == 0 || height == 0 || width.max(height) > MAX_SIDE {
                return Err(format!(
                    "it has {width} × {height} texels; sides have 1 to {MAX_SIDE}: make it smaller"
                ));
            }
            match *texels <= MAX_TEXELS {
                true => Ok(()),
                false => Err(format!(
                    "the pictures have more than {MAX_TEXELS} texels together; make them smaller"
                )),
            }
        };
        let picture = decode_rgba(contents, accept)
            .map_err(|error| container.error(ModelFault::Image(cause(error)), &pointer))?;
        Ok(ModelImage {
            size: picture.size,
            rgba: picture.rgba,
        })
    }
}
