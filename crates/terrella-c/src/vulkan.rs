//! Drawing with a program's own Vulkan device into its own images, without a copy through the CPU.

use crate::camera::TerrellaCamera;
use crate::failure::{Failure, TerrellaStatus, answer};
use crate::handles;
use crate::options::{TerrellaOptions, Wanted};
use crate::picture::{TerrellaDrawn, tell_drawn, wait};
use crate::pointers::{check_out, read, row, text, write};
use crate::time::TerrellaTime;
use ash::vk::{self, Handle};
use std::ffi::{CStr, c_char, c_void};
use terrella::Attachments;
use terrella::wgpu::{self, hal};
use terrella::{Drawing, Earth, EarthOptions, FrameRequest, Sky};

/// An Earth on a program's own Vulkan device. An opaque handle. The caller orders calls: no other thread submits to the queue during a
/// call.
pub struct TerrellaVulkanEarth {
    _private: [u8; 0],
}

const KIND: &str = "an Earth on Vulkan";

/// The program's Vulkan objects. They must outlive what is made with them.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TerrellaVulkanHost {
    /// The function vkGetInstanceProcAddr, as a PFN_vkVoidFunction.
    pub get_instance_proc_addr: Option<unsafe extern "C" fn()>,
    /// The VkInstance.
    pub instance: *mut c_void,
    /// The VkPhysicalDevice.
    pub physical_device: *mut c_void,
    /// The VkDevice, made with all extensions that `terrella_vulkan_extension` names and with the features that the physical device has (as
    /// vkGetPhysicalDeviceFeatures gives them). May be null where only extensions are asked for.
    pub device: *mut c_void,
    /// The version of Vulkan that the instance was made for, as VK_MAKE_API_VERSION; at least 1.1.
    pub api_version: u32,
    /// Family of the queue, which must support graphics.
    pub queue_family: u32,
    /// Index of the queue in its family.
    pub queue_index: u32,
    /// Names of the device's enabled extensions.
    pub device_extensions: *const *const c_char,
    /// Number of these extensions.
    pub device_extension_count: usize,
}

/// Layout of an image after drawing: a constant that begins with `TERRELLA_LAYOUT`.
pub type TerrellaLayout = u32;

/// To be copied from: VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL. The image has VK_IMAGE_USAGE_TRANSFER_SRC_BIT.
pub const TERRELLA_LAYOUT_TRANSFER: TerrellaLayout = 0;
/// To be read by shaders: VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL. The image has VK_IMAGE_USAGE_SAMPLED_BIT.
pub const TERRELLA_LAYOUT_SHADER: TerrellaLayout = 1;
/// To be drawn over: VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL.
pub const TERRELLA_LAYOUT_ATTACHMENT: TerrellaLayout = 2;

/// An image of the program to draw into.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct TerrellaVulkanImage {
    /// The VkImage: two-dimensional, one level, one layer, one sample, exclusive to the queue's family, usage
    /// VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT and what `layout` needs. Its contents are discarded.
    pub image: u64,
    /// Width, pixels.
    pub width: u32,
    /// Height, pixels.
    pub height: u32,
    /// Its layout after drawing.
    pub layout: TerrellaLayout,
}

/// An Earth and the objects that keep its device alive.
struct VulkanEarth {
    earth: Earth,
    format: wgpu::TextureFormat,
    samples: u32,
    attachments: Option<((u32, u32), Attachments)>,
    device: wgpu::Device,
    queue: wgpu::Queue,
    // Dropped after the device.
    _adapter: wgpu::Adapter,
    _instance: wgpu::Instance,
}

impl Drop for VulkanEarth {
    fn drop(&mut self) {
        // The GPU may still use objects that are dropped now. A lost device needs no wait.
        let _ = self.device.poll(wgpu::PollType::wait_indefinitely());
    }
}

/// Image formats by their VkFormat numbers.
const FORMATS: [(u32, wgpu::TextureFormat); 5] = [
    (37, wgpu::TextureFormat::Rgba8Unorm),
    (43, wgpu::TextureFormat::Rgba8UnormSrgb),
    (44, wgpu::TextureFormat::Bgra8Unorm),
    (50, wgpu::TextureFormat::Bgra8UnormSrgb),
    (97, wgpu::TextureFormat::Rgba16Float),
];

struct Opened {
    instance: hal::vulkan::Instance,
    raw_instance: ash::Instance,
    exposed: hal::ExposedAdapter<hal::api::Vulkan>,
}

/// Opens the program's instance and exposes its physical device.
///
/// # Safety
/// As the fields of [`TerrellaVulkanHost`] require.
unsafe fn open(host: &TerrellaVulkanHost) -> Result<Opened, Failure> {
    let null = |name: &str| Failure::new(TerrellaStatus::TERRELLA_NULL, format!("{name} is null"));
    let function = host
        .get_instance_proc_addr
        .ok_or_else(|| null("host.get_instance_proc_addr"))?;
    for (pointer, name) in [
        (host.instance, "host.instance"),
        (host.physical_device, "host.physical_device"),
    ] {
        if pointer.is_null() {
            return Err(null(name));
        }
    }
    if host.api_version < vk::API_VERSION_1_1 {
        return Err(Failure::argument(
            "host.api_version: Vulkan 1.1 is needed; write VK_API_VERSION_1_1 or later where the instance is made",
        ));
    }
    // SAFETY: by the caller's promise that function.
    let get_instance_proc_addr = unsafe {
        std::mem::transmute::<unsafe extern "C" fn(), vk::PFN_vkGetInstanceProcAddr>(function)
    };
    let functions = ash::StaticFn {
        get_instance_proc_addr,
    };
    // SAFETY: the function stays loaded as long as the host's instance lives.
    let entry = unsafe { ash::Entry::from_static_fn(functions) };
    let handle = vk::Instance::from_raw(host.instance.addr() as u64);
    // SAFETY: by the caller's promise an instance of that function.
    let raw_instance = unsafe { ash::Instance::load(entry.static_fn(), handle) };
    // SAFETY: the instance is the host's and stays it: the callback takes it from wgpu. No extension is claimed.
    let instance = unsafe {
        hal::vulkan::Instance::from_raw(
            entry,
            raw_instance.clone(),
            host.api_version,
            0,
            None,
            Vec::new(),
            wgpu::InstanceFlags::empty(),
            wgpu::MemoryBudgetThresholds::default(),
            false,
            Some(Box::new(|| ())),
        )
    };
    let instance = instance.map_err(Failure::device)?;
    let physical = vk::PhysicalDevice::from_raw(host.physical_device.addr() as u64);
    let exposed = instance.expose_adapter(physical).ok_or_else(|| {
        Failure::device("host.physical_device: this device cannot do what drawing needs")
    })?;
    Ok(Opened {
        instance,
        raw_instance,
        exposed,
    })
}

fn needed(opened: &Opened) -> Vec<&'static CStr> {
    let adapter = &opened.exposed.adapter;
    adapter.required_device_extensions(wgpu::Features::empty())
}

/// Returns a device extension that the host must enable, by its index from 0; null after the last one. Call it before vkCreateDevice. Names
/// are never freed.
///
/// # Safety
/// `host` points to Vulkan objects as its fields say; `device` and `device_extensions` are not read. `name` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_vulkan_extension(
    host: *const TerrellaVulkanHost,
    index: usize,
    name: *mut *const c_char,
) -> TerrellaStatus {
    answer(|| {
        check_out(name, "name")?;
        // SAFETY: the caller's promise.
        let host = unsafe { read(host, "host") }?;
        // SAFETY: the same.
        let opened = unsafe { open(host) }?;
        let found = needed(&opened).get(index).map(|name| name.as_ptr());
        // SAFETY: the caller's promise.
        unsafe { write(name, "name", found.unwrap_or(std::ptr::null())) }
    })
}

/// Creates an Earth on the host's device, for images of a format: VK_FORMAT_R8G8B8A8_UNORM (37) or _SRGB (43), VK_FORMAT_B8G8R8A8_UNORM
/// (44) or _SRGB (50) for display, VK_FORMAT_R16G16B16A16_SFLOAT (97) for linear light. `width`, `height` and `adapter` of the options are not
/// used. On failure `*earth` is unchanged.
///
/// # Safety
/// `host` points to Vulkan objects as its fields say, which outlive the Earth; texts end with zero bytes; `earth` points to writable
/// memory. Nobody submits to the queue during the call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_vulkan_earth_new(
    host: *const TerrellaVulkanHost,
    options: *const TerrellaOptions,
    vk_format: u32,
    earth: *mut *mut TerrellaVulkanEarth,
) -> TerrellaStatus {
    answer(|| {
        check_out(earth, "earth")?;
        // SAFETY: the caller's promise.
        let host = unsafe { read(host, "host") }?;
        let format = FORMATS.iter().find(|(number, _)| *number == vk_format);
        let (_, format) = *format.ok_or_else(|| {
            Failure::argument(format!(
                "vk_format: {vk_format} is none of 37, 43, 44, 50, 97 (8-bit RGBA or BGRA, plain or sRGB, and 16-bit float)"
            ))
        })?;
        if host.device.is_null() {
            return Err(Failure::new(
                TerrellaStatus::TERRELLA_NULL,
                "host.device is null",
            ));
        }
        // SAFETY: the caller's promise.
        let opened = unsafe { open(host) }?;
        // SAFETY: the same.
        let enabled = unsafe {
            row(
                host.device_extensions,
                host.device_extension_count,
                "host.device_extensions",
            )
        }?;
        let mut names = Vec::new();
        for name in enabled {
            // SAFETY: the same: texts that end with zero bytes.
            names.push(unsafe { text(*name, "host.device_extensions") }?);
        }
        let needed = needed(&opened);
        let missing = needed.iter().map(|name| name.to_string_lossy());
        let missing: Vec<_> = missing
            .filter(|name| !names.contains(&name.as_ref()))
            .collect();
        if !missing.is_empty() {
            return Err(Failure::device(format!(
                "host.device_extensions: the device was made without {}; terrella_vulkan_extension names what it needs",
                missing.join(", ")
            )));
        }
        // SAFETY: the caller's promise.
        let options = unsafe { Wanted::read(options) }?.with_maps()?;
        // SAFETY: the same.
        let made = unsafe { make(host, opened, &needed, options, format) }?;
        // SAFETY: the same.
        unsafe { write(earth, "earth", handles::insert(KIND, made)) }
    })
}

/// # Safety
/// As [`terrella_vulkan_earth_new`]; the device was made with these extensions.
unsafe fn make(
    host: &TerrellaVulkanHost,
    opened: Opened,
    extensions: &[&'static CStr],
    mut options: EarthOptions,
    format: wgpu::TextureFormat,
) -> Result<VulkanEarth, Failure> {
    let Opened {
        instance,
        raw_instance,
        exposed,
    } = opened;
    let handle = vk::Device::from_raw(host.device.addr() as u64);
    // SAFETY: by the caller's promise a device of that instance.
    let raw_device = unsafe { ash::Device::load(raw_instance.fp_v1_0(), handle) };
    let limits = exposed.capabilities.limits.clone();
    // SAFETY: the device is of this physical device, has these extensions and that queue by the caller's promise, and stays the host's.
    let open = unsafe {
        exposed.adapter.device_from_raw(
            raw_device,
            Some(Box::new(|| ())),
            extensions,
            wgpu::Features::empty(),
            &limits,
            &wgpu::MemoryHints::default(),
            host.queue_family,
            host.queue_index,
        )
    };
    let open = open.map_err(Failure::device)?;
    // SAFETY: the instance is whole and is used by wgpu alone from here on.
    let instance = unsafe { wgpu::Instance::from_hal::<hal::api::Vulkan>(instance) };
    // SAFETY: the adapter came from that instance.
    let adapter = unsafe { instance.create_adapter_from_hal(exposed) };
    let descriptor = wgpu::DeviceDescriptor {
        label: Some("terrella host device"),
        required_limits: limits,
        ..Default::default()
    };
    // SAFETY: the open device came from that adapter, with these features and limits.
    let opened = unsafe { adapter.create_device_from_hal(open, &descriptor) };
    let (device, queue) = opened.map_err(Failure::device)?;
    options.color_format = format;
    let flags = adapter.get_texture_format_features(format).flags;
    if !flags.sample_count_supported(options.samples) {
        return Err(Failure::device(format!(
            "options.samples: this device does not support {} samples per pixel in this format",
            options.samples
        )));
    }
    let earth = Earth::new(&device, &queue, &options).map_err(Failure::device)?;
    Ok(VulkanEarth {
        earth,
        format,
        samples: options.samples,
        attachments: None,
        device,
        queue,
        _adapter: adapter,
        _instance: instance,
    })
}

/// Frees an Earth on Vulkan, after the device has finished drawing. Call it before you destroy the device. No other
/// thread may use this Earth then: a call in progress would keep its objects after this one returns.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_vulkan_earth_free(earth: *mut TerrellaVulkanEarth) -> TerrellaStatus {
    answer(|| handles::remove(earth, KIND, "earth"))
}

/// Draws into an image of the host: submits to its queue and does not wait. Later submissions to that queue see the picture. Keep the image
/// until the queue has finished. The first row is at the top, as in Vulkan. Waits for tiles, at most `wait_s` seconds. `drawn`
/// may be null.
///
/// # Safety
/// `camera` points to a camera, `image` to a description that is true of an image of the host's device; nobody else submits to the queue or
/// uses the image during the call; `drawn` is null or points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_vulkan_draw(
    earth: *mut TerrellaVulkanEarth,
    camera: *const TerrellaCamera,
    time: TerrellaTime,
    wait_s: f64,
    image: *const TerrellaVulkanImage,
    drawn: *mut TerrellaDrawn,
) -> TerrellaStatus {
    answer(|| {
        // SAFETY: the caller's promise.
        let view = unsafe { read(camera, "camera") }?.view("camera")?;
        let sky = Sky::at(time.epoch("time")?);
        let wait = wait(wait_s)?;
        // SAFETY: the same.
        let image = *unsafe { read(image, "image") }?;
        let end = match image.layout {
            TERRELLA_LAYOUT_TRANSFER => wgpu::TextureUses::COPY_SRC,
            TERRELLA_LAYOUT_SHADER => wgpu::TextureUses::RESOURCE,
            TERRELLA_LAYOUT_ATTACHMENT => wgpu::TextureUses::COLOR_TARGET,
            other => {
                return Err(Failure::argument(format!(
                    "image.layout: {other} is none of the TERRELLA_LAYOUT numbers"
                )));
            }
        };
        if image.image == 0 {
            return Err(Failure::new(
                TerrellaStatus::TERRELLA_NULL,
                "image.image is null",
            ));
        }
        handles::with(earth, KIND, "earth", |this: &mut VulkanEarth| {
            // SAFETY: the same.
            let drawing = unsafe { this.draw(&view, &sky, wait, image, end) }?;
            // SAFETY: the same.
            unsafe { tell_drawn(drawn, &drawing) }
        })
    })
}

impl VulkanEarth {
    /// # Safety
    /// As [`terrella_vulkan_draw`].
    unsafe fn draw(
        &mut self,
        view: &terrella::EyeView,
        sky: &Sky,
        wait: std::time::Duration,
        image: TerrellaVulkanImage,
        end: wgpu::TextureUses,
    ) -> Result<Drawing, Failure> {
        let size = (image.width, image.height);
        let limit = self.device.limits().max_texture_dimension_2d;
        if !(1..=limit).contains(&size.0) || !(1..=limit).contains(&size.1) {
            return Err(Failure::argument(format!(
                "image: {} × {} pixels; this device draws from 1 to {limit} pixels a side",
                size.0, size.1
            )));
        }
        // Frees resources of earlier frames that are finished.
        self.device
            .poll(wgpu::PollType::Poll)
            .map_err(Failure::device)?;
        // SAFETY: the caller's promise.
        let texture = unsafe { self.texture(image, end) }?;
        let (format, samples, device) = (self.format, self.samples, &self.device);
        let fitting = self.attachments.take().filter(|(of, _)| *of == size);
        let attachments =
            fitting.unwrap_or_else(|| (size, Attachments::new(device, size, format, samples)));
        let (_, attachments) = self.attachments.insert(attachments);
        let (stats, missing) =
            self.earth
                .prepare_complete(&self.queue, FrameRequest::new(view, sky, size), wait);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella host image"),
        });
        let target = texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("terrella host image"),
            ..Default::default()
        });
        self.earth
            .render(&mut attachments.begin_pass(&mut encoder, &target));
        let transition = wgpu::wgt::TextureTransition {
            texture: &texture,
            selector: None,
            state: end,
        };
        let no_buffers = std::iter::empty::<wgpu::wgt::BufferTransition<&wgpu::Buffer>>();
        encoder.transition_resources(no_buffers, [transition].into_iter());
        self.queue.submit([encoder.finish()]);
        Ok(Drawing { stats, missing })
    }

    /// Wraps the host's image as a wgpu texture.
    ///
    /// # Safety
    /// As [`terrella_vulkan_draw`].
    unsafe fn texture(
        &self,
        image: TerrellaVulkanImage,
        end: wgpu::TextureUses,
    ) -> Result<wgpu::Texture, Failure> {
        let size = wgpu::Extent3d {
            width: image.width,
            height: image.height,
            depth_or_array_layers: 1,
        };
        let further = match image.layout {
            TERRELLA_LAYOUT_TRANSFER => wgpu::TextureUsages::COPY_SRC,
            TERRELLA_LAYOUT_SHADER => wgpu::TextureUsages::TEXTURE_BINDING,
            _ => wgpu::TextureUsages::empty(),
        };
        let of_hal = hal::TextureDescriptor {
            label: Some("terrella host image"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: wgpu::TextureUses::COLOR_TARGET | end,
            memory_flags: hal::MemoryFlags::empty(),
            view_formats: Vec::new(),
        };
        let texture = {
            // SAFETY: the device is not destroyed through it.
            let device = unsafe { self.device.as_hal::<hal::api::Vulkan>() };
            let device = device.ok_or_else(|| Failure::device("the device is not Vulkan's"))?;
            // SAFETY: by the caller's promise such an image of this device; it stays the host's, and so does its memory.
            unsafe {
                device.texture_from_raw(
                    vk::Image::from_raw(image.image),
                    &of_hal,
                    Some(Box::new(|| ())),
                    hal::vulkan::TextureMemory::External,
                )
            }
        };
        let descriptor = wgpu::TextureDescriptor {
            label: Some("terrella host image"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | further,
            view_formats: &[],
        };
        // SAFETY: made from this device a moment ago, by the same description; what is in it is not kept.
        Ok(unsafe {
            self.device.create_texture_from_hal::<hal::api::Vulkan>(
                texture,
                &descriptor,
                wgpu::TextureUses::UNINITIALIZED,
            )
        })
    }
}
