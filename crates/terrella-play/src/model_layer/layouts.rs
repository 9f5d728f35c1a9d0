//! Layouts of what the shader of models reads.

/// What the shader of models reads: layouts of the craft, and of a material without and with a normal map.
pub struct ModelLayouts {
    pub frame: wgpu::BindGroupLayout,
    materials: [wgpu::BindGroupLayout; 2],
}

impl ModelLayouts {
    pub fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        };
        let uniform = wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: None,
        };
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let layout = |label, entries: &[wgpu::BindGroupLayoutEntry]| {
            device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some(label),
                entries,
            })
        };
        Self {
            frame: layout(
                "terrella model craft",
                &[entry(0, wgpu::ShaderStages::VERTEX_FRAGMENT, uniform)],
            ),
            materials: [3, 4].map(|textures| {
                let mut entries = vec![entry(0, fragment, uniform)];
                for slot in 0..textures {
                    entries.push(entry(2 * slot + 1, fragment, texture));
                    entries.push(entry(2 * slot + 2, fragment, sampler));
                }
                layout("terrella model material", &entries)
            }),
        }
    }

    /// That of a material.
    pub fn material(&self, normal_map: bool) -> &wgpu::BindGroupLayout {
        let [without, with] = &self.materials;
        if normal_map { with } else { without }
    }
}
