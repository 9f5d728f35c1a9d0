//! Checks for a Vulkan driver with a device, from files only, before anything is built.
//!
//! The Vulkan loader finds drivers by JSON manifests. Distributions install the manifests of all vendors, so a manifest proves nothing about the
//! machine: each is compared with the existing devices. The final check is `terrella doctor`, which opens the adapter.

use serde_json::Value;
use std::ffi::OsString;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// No manifest is nearly this long; a longer file is something else.
const MANIFEST_LIMIT_BYTES: u64 = 64 * 1024;

/// The device that a driver needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Needs {
    /// None: the CPU renders.
    Nothing,
    /// A render node with this PCI vendor number.
    Maker(&'static str),
    /// A device file.
    Device(&'static str),
    /// Any render node: the driver is not in the table.
    RenderNode,
}

/// Parts of library names and the device that such a driver needs. The first match counts.
const DRIVERS: &[(&str, Needs)] = &[
    ("vulkan_lvp", Needs::Nothing),
    ("swiftshader", Needs::Nothing),
    ("vulkan_intel", Needs::Maker("0x8086")),
    ("vulkan_radeon", Needs::Maker("0x1002")),
    ("amdvlk", Needs::Maker("0x1002")),
    ("vulkan_nouveau", Needs::Maker("0x10de")),
    ("vulkan_virtio", Needs::Maker("0x1af4")),
    ("nvidia", Needs::Device("/dev/nvidiactl")),
    ("vulkan_dzn", Needs::Device("/dev/dxg")),
];

/// One driver manifest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Driver {
    /// File name of the manifest.
    pub name: String,
    /// It renders on the CPU.
    pub software: bool,
    /// The reason why it cannot be used; `None` if it can.
    pub problem: Option<String>,
}

impl fmt::Display for Driver {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.problem {
            Some(problem) => write!(f, "{} ({problem})", self.name),
            None => f.write_str(&self.name),
        }
    }
}

/// The Vulkan installation of the machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Vulkan {
    /// Whether `libvulkan.so.1` exists.
    pub loader: bool,
    /// All drivers whose manifests the loader would read.
    pub drivers: Vec<Driver>,
}

impl Vulkan {
    /// The usable drivers. Hardware drivers come before software.
    pub fn usable(&self) -> Vec<&Driver> {
        let mut usable: Vec<_> = self
            .drivers
            .iter()
            .filter(|d| d.problem.is_none())
            .collect();
        usable.sort_by_key(|d| d.software);
        if self.loader { usable } else { Vec::new() }
    }

    /// Whether a software driver exists.
    pub fn has_software(&self) -> bool {
        self.usable().iter().any(|driver| driver.software)
    }
}

/// The machine as this module sees it: a root folder and the environment.
pub struct Host<'a> {
    /// `/`, or a folder laid out like one.
    pub root: &'a Path,
    /// Reads an environment variable.
    pub env: &'a dyn Fn(&str) -> Option<OsString>,
}

impl Host<'_> {
    fn at(&self, absolute: impl AsRef<Path>) -> PathBuf {
        let absolute = absolute.as_ref();
        self.root
            .join(absolute.strip_prefix("/").unwrap_or(absolute))
    }

    /// The folders or files of a variable with the system's separator.
    fn paths(&self, variable: &str) -> Vec<PathBuf> {
        (self.env)(variable)
            .map(|value| {
                std::env::split_paths(&value)
                    .filter(|p| !p.as_os_str().is_empty())
                    .collect()
            })
            .unwrap_or_default()
    }

    /// Whether a shared library is in one of the dynamic linker's folders.
    pub fn has_library(&self, file_name: &str) -> bool {
        let architecture = std::env::consts::ARCH;
        let mut folders = self.paths("LD_LIBRARY_PATH");
        folders.extend(
            [
                format!("/usr/lib/{architecture}-linux-gnu"),
                format!("/lib/{architecture}-linux-gnu"),
                "/usr/lib64".into(),
                "/lib64".into(),
                "/usr/lib".into(),
                "/lib".into(),
                "/usr/local/lib".into(),
                format!("/usr/local/lib/{architecture}-linux-gnu"),
            ]
            .map(|folder| self.at(folder)),
        );
        folders.iter().any(|folder| folder.join(file_name).exists())
    }

    /// The drivers that the Vulkan loader would find.
    pub fn vulkan(&self) -> Vulkan {
        let mut manifests = self.manifests();
        manifests.sort();
        manifests.dedup();
        Vulkan {
            loader: self.has_library("libvulkan.so.1"),
            drivers: manifests.iter().map(|path| self.driver(path)).collect(),
        }
    }

    /// The manifests, by the loader's own search order ("Loader and driver interface", Vulkan-Loader documentation).
    fn manifests(&self) -> Vec<PathBuf> {
        for variable in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
            let chosen = self.paths(variable);
            if !chosen.is_empty() {
                return chosen.iter().flat_map(|path| manifests_at(path)).collect();
            }
        }
        let mut folders = self.paths("VK_ADD_DRIVER_FILES");
        let or_default = |variable: &str, default: &[&str]| {
            let set = self.paths(variable);
            if set.is_empty() {
                default.iter().map(|p| self.at(p)).collect()
            } else {
                set
            }
        };
        let home = (self.env)("HOME").map(PathBuf::from);
        let mut bases = Vec::new();
        bases.extend(self.paths("XDG_CONFIG_HOME"));
        bases.extend(home.iter().map(|home| home.join(".config")));
        bases.extend(or_default("XDG_CONFIG_DIRS", &["/etc/xdg"]));
        bases.extend(["/etc", "/usr/local/etc"].map(|p| self.at(p)));
        bases.extend(self.paths("XDG_DATA_HOME"));
        bases.extend(home.iter().map(|home| home.join(".local/share")));
        bases.extend(or_default(
            "XDG_DATA_DIRS",
            &["/usr/local/share", "/usr/share"],
        ));
        folders.extend(bases.into_iter().map(|base| base.join("vulkan/icd.d")));
        folders.iter().flat_map(|path| manifests_at(path)).collect()
    }

    fn driver(&self, manifest: &Path) -> Driver {
        let name = manifest.file_name().map_or_else(
            || manifest.display().to_string(),
            |n| n.to_string_lossy().into_owned(),
        );
        let broken = |problem: String| Driver {
            name: name.clone(),
            software: false,
            problem: Some(problem),
        };
        let (library, architecture) = match read_manifest(manifest) {
            Ok(read) => read,
            Err(problem) => return broken(problem),
        };
        if architecture
            .as_deref()
            .is_some_and(|bits| bits != usize::BITS.to_string())
        {
            return broken("made for another processor".into());
        }
        // The loader's rule: the dynamic linker resolves a bare name; anything else is a path.
        let there = if !library.contains('/') {
            self.has_library(&library)
        } else if library.starts_with('/') {
            self.at(&library).exists()
        } else {
            manifest
                .parent()
                .is_some_and(|folder| folder.join(&library).exists())
        };
        if !there {
            return broken(format!("{library} is not there"));
        }
        let file = library
            .rsplit('/')
            .next()
            .unwrap_or(&library)
            .to_ascii_lowercase();
        let needs = DRIVERS
            .iter()
            .find(|(part, _)| file.contains(part))
            .map_or(Needs::RenderNode, |(_, needs)| *needs);
        Driver {
            name,
            software: needs == Needs::Nothing,
            problem: self.lacks(needs),
        }
    }

    /// The device that a driver lacks on this machine.
    fn lacks(&self, needs: Needs) -> Option<String> {
        match needs {
            Needs::Nothing => None,
            Needs::Device(path) => match can_open(&self.at(path)) {
                true => None,
                false => Some(format!("{path} is missing or may not be opened")),
            },
            Needs::Maker(_) | Needs::RenderNode => {
                let nodes = self.render_nodes();
                if nodes.is_empty() {
                    return Some("no device".into());
                }
                let fits = |node: &&(String, String)| match needs {
                    Needs::Maker(maker) => node.1 == maker,
                    _ => true,
                };
                let fitting: Vec<_> = nodes.iter().filter(fits).collect();
                if fitting.is_empty() {
                    return Some("no device of this maker".into());
                }
                let opens = |node: &str| can_open(&self.at(format!("/dev/dri/{node}")));
                match fitting.iter().any(|(node, _)| opens(node)) {
                    true => None,
                    false => {
                        Some("its device may not be opened: are you in the group `render`?".into())
                    }
                }
            }
        }
    }

    /// Names of the render nodes with their vendor numbers (empty if not on PCI).
    fn render_nodes(&self) -> Vec<(String, String)> {
        let Ok(entries) = fs::read_dir(self.at("/sys/class/drm")) else {
            return Vec::new();
        };
        entries
            .flatten()
            .filter_map(|entry| {
                let name = entry.file_name().into_string().ok()?;
                let maker = fs::read_to_string(entry.path().join("device/vendor"))
                    .map(|text| text.trim().to_string())
                    .unwrap_or_default();
                name.starts_with("renderD").then_some((name, maker))
            })
            .collect()
    }
}

/// A manifest, or all manifests in a folder.
fn manifests_at(path: &Path) -> Vec<PathBuf> {
    if path.is_file() {
        return vec![path.to_path_buf()];
    }
    let Ok(entries) = fs::read_dir(path) else {
        return Vec::new();
    };
    entries
        .flatten()
        .map(|entry| entry.path())
        .filter(|path| {
            path.extension()
                .is_some_and(|extension| extension == "json")
        })
        .collect()
}

/// `library_path` and `library_arch` of a manifest, or the reason why it is unusable.
fn read_manifest(path: &Path) -> Result<(String, Option<String>), String> {
    let size_bytes = fs::metadata(path).map_err(|error| error.to_string())?.len();
    if size_bytes > MANIFEST_LIMIT_BYTES {
        return Err(format!("{size_bytes} bytes are too many for a manifest"));
    }
    let text = fs::read_to_string(path).map_err(|error| error.to_string())?;
    let json: Value = serde_json::from_str(&text).map_err(|error| error.to_string())?;
    let key = |key: &str| Some(json.get("ICD")?.get(key)?.as_str()?.to_string());
    match key("library_path") {
        Some(library) => Ok((library, key("library_arch"))),
        None => Err("it has no ICD.library_path".into()),
    }
}

/// Whether a device file can be opened: in containers many are visible but forbidden.
fn can_open(path: &Path) -> bool {
    fs::OpenOptions::new()
        .read(true)
        .write(true)
        .open(path)
        .is_ok()
}

#[cfg(test)]
mod tests;
