//! Machines laid out in a temporary folder.

use super::*;
use std::collections::HashMap;

struct Laid {
    root: tempfile::TempDir,
    env: HashMap<&'static str, OsString>,
}

impl Laid {
    fn new() -> Self {
        let root = tempfile::tempdir().unwrap();
        Self {
            root,
            env: HashMap::new(),
        }
    }

    fn file(self, path: &str, text: &str) -> Self {
        let path = self.root.path().join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
        self
    }

    fn library(self, name: &str) -> Self {
        let path = format!("usr/lib/{}-linux-gnu/{name}", std::env::consts::ARCH);
        self.file(&path, "")
    }

    fn loader(self) -> Self {
        self.library("libvulkan.so.1")
    }

    fn manifest(self, name: &str, library: &str) -> Self {
        let text = format!(r#"{{"ICD": {{"api_version": "1.3", "library_path": "{library}"}}}}"#);
        self.file(&format!("usr/share/vulkan/icd.d/{name}"), &text)
    }

    fn driver(self, short: &str) -> Self {
        let library = format!("libvulkan_{short}.so");
        self.library(&library)
            .manifest(&format!("{short}_icd.json"), &library)
    }

    fn card(self, maker: &str) -> Self {
        self.file(
            "sys/class/drm/renderD128/device/vendor",
            &format!("{maker}\n"),
        )
        .file("dev/dri/renderD128", "")
    }

    fn found(&self) -> Vulkan {
        let env = |name: &str| self.env.get(name).cloned();
        Host {
            root: self.root.path(),
            env: &env,
        }
        .vulkan()
    }
}

fn names(found: &Vulkan) -> Vec<&str> {
    found.usable().iter().map(|d| d.name.as_str()).collect()
}

#[test]
fn a_bare_machine_has_nothing() {
    let found = Laid::new().found();
    assert!(!found.loader && found.drivers.is_empty() && !found.has_software());
}

#[test]
fn software_needs_no_device() {
    let found = Laid::new().loader().driver("lvp").found();
    assert_eq!(names(&found), ["lvp_icd.json"]);
    assert!(found.has_software());
}

#[test]
fn a_driver_without_the_loader_is_no_use() {
    let found = Laid::new().driver("lvp").found();
    assert!(names(&found).is_empty() && !found.has_software());
}

#[test]
fn a_card_driver_counts_only_with_its_card() {
    let both = || Laid::new().loader().driver("intel").driver("radeon");
    let without = both().found();
    assert!(names(&without).is_empty());
    assert!(
        without
            .drivers
            .iter()
            .all(|d| d.problem.as_deref() == Some("no device"))
    );
    let with = both().card("0x1002").found();
    assert_eq!(names(&with), ["radeon_icd.json"]);
    assert!(!with.has_software());
}

#[test]
fn a_card_comes_before_software() {
    let found = Laid::new()
        .loader()
        .driver("lvp")
        .driver("radeon")
        .card("0x1002")
        .found();
    assert_eq!(names(&found), ["radeon_icd.json", "lvp_icd.json"]);
}

#[test]
fn a_node_that_may_not_be_opened_does_not_count() {
    // The node is listed but the device file is missing, as in a container.
    let found = Laid::new()
        .loader()
        .driver("intel")
        .file("sys/class/drm/renderD128/device/vendor", "0x8086")
        .found();
    assert!(names(&found).is_empty());
    assert!(
        found.drivers[0]
            .problem
            .as_deref()
            .unwrap()
            .contains("render")
    );
}

#[test]
fn nvidia_needs_its_control_device() {
    let laid = || {
        Laid::new()
            .loader()
            .library("libGLX_nvidia.so.0")
            .manifest("nvidia_icd.json", "libGLX_nvidia.so.0")
    };
    assert!(names(&laid().found()).is_empty());
    assert_eq!(
        names(&laid().file("dev/nvidiactl", "").found()),
        ["nvidia_icd.json"]
    );
}

#[test]
fn an_unknown_driver_needs_any_node() {
    assert!(names(&Laid::new().loader().driver("other").found()).is_empty());
    assert_eq!(
        names(&Laid::new().loader().driver("other").card("0x9999").found()),
        ["other_icd.json"]
    );
}

#[test]
fn a_manifest_without_its_library_does_not_count() {
    for library in [
        "libvulkan_lvp.so",
        "/usr/lib/gone/libvulkan_lvp.so",
        "./libvulkan_lvp.so",
    ] {
        let found = Laid::new()
            .loader()
            .manifest("lvp_icd.json", library)
            .found();
        assert!(names(&found).is_empty(), "{library}");
        assert!(
            found.drivers[0]
                .problem
                .as_deref()
                .unwrap()
                .contains("not there"),
            "{library}"
        );
    }
}

#[test]
fn an_absolute_library_path_is_read() {
    let found = Laid::new()
        .loader()
        .file("opt/libvulkan_lvp.so", "")
        .manifest("lvp_icd.json", "/opt/libvulkan_lvp.so")
        .found();
    assert!(found.has_software());
}

#[test]
fn a_bad_manifest_says_why() {
    let long = " ".repeat(70_000);
    for (text, why) in [
        ("{", "EOF"),
        ("{}", "library_path"),
        (long.as_str(), "too many"),
    ] {
        let found = Laid::new()
            .loader()
            .file("etc/vulkan/icd.d/x.json", text)
            .found();
        assert!(
            found.drivers[0].problem.as_deref().unwrap().contains(why),
            "{found:?}"
        );
    }
    let other = r#"{"ICD": {"library_path": "libvulkan_lvp.so", "library_arch": "16"}}"#;
    let found = Laid::new()
        .loader()
        .library("libvulkan_lvp.so")
        .file("etc/vulkan/icd.d/x.json", other)
        .found();
    assert!(names(&found).is_empty());
}

#[test]
fn the_variables_choose_the_drivers() {
    let mut laid = Laid::new().loader().driver("lvp");
    laid.env
        .insert("VK_ICD_FILENAMES", "/nowhere/x.json".into());
    assert!(
        laid.found().drivers.is_empty(),
        "a variable that names nothing hides the rest"
    );
    let manifest = laid.root.path().join("usr/share/vulkan/icd.d/lvp_icd.json");
    laid.env.insert("VK_DRIVER_FILES", manifest.into());
    assert!(
        laid.found().has_software(),
        "the newer variable counts before the older"
    );
}
