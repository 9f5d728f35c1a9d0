//! The state of this machine: what is installed of the tools and libraries for building and drawing.

use crate::vulkan::{Host, Vulkan};
use std::ffi::OsString;
use std::path::Path;
use std::process::{Command, Stdio};

/// The kind of display for a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Display {
    /// No display.
    None,
    /// An X server.
    X11,
    /// A Wayland compositor.
    Wayland,
    /// The system always has one (Windows, macOS).
    Native,
}

/// How packages can be installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Installer {
    /// apt-get as root.
    Apt,
    /// apt-get through `sudo` without a password.
    AptThroughSudo,
    /// apt-get exists, but only the user can become root.
    AptForbidden,
    /// Not a Debian-like system.
    Unknown,
}

/// The state of the machine.
#[derive(Clone, Debug)]
pub struct Machine {
    /// Drivers; `None` if the system has its own graphics interface (Windows, macOS).
    pub vulkan: Option<Vulkan>,
    /// Whether a C++ compiler exists (openh264 and the image comparison of the tests are C++).
    pub cxx: bool,
    /// The display for a window.
    pub display: Display,
    /// Debian names of missing packages with libraries that a window opens at run time.
    pub window_packages: Vec<&'static str>,
    /// Debian names of missing packages for the window of the tests: a display server without a screen, and the libraries.
    pub test_window_packages: Vec<&'static str>,
    /// Debian names of missing packages for the tests of the C and Python packages.
    pub face_packages: Vec<&'static str>,
    /// How packages can be installed.
    pub installer: Installer,
}

/// Python programs that the tests try, like `crates/terrella-py/tests/python.rs`.
const PYTHONS: [&str; 2] = ["python3", "/usr/bin/python3"];

/// Exits with 0 if a Python satisfies the tests.
const PYTHON_TESTS: &str = "import sys, numpy, pytest; sys.exit(sys.version_info < (3, 10))";

/// The display server of the tests.
const DISPLAY_SERVER: (&str, &str) = ("Xvfb", "xvfb");

/// Libraries that winit and wgpu open at run time on X11, each with its Debian package.
const X11_LIBRARIES: &[(&str, &str)] = &[
    ("libX11.so.6", "libx11-6"),
    ("libX11-xcb.so.1", "libx11-xcb1"),
    ("libXcursor.so.1", "libxcursor1"),
    ("libXi.so.6", "libxi6"),
    ("libxkbcommon.so.0", "libxkbcommon0"),
    ("libxkbcommon-x11.so.0", "libxkbcommon-x11-0"),
];

/// The same on Wayland.
const WAYLAND_LIBRARIES: &[(&str, &str)] = &[
    ("libwayland-client.so.0", "libwayland-client0"),
    ("libwayland-egl.so.1", "libwayland-egl1"),
    ("libxkbcommon.so.0", "libxkbcommon0"),
];

/// The display for a window, from the environment.
pub fn display(env: &dyn Fn(&str) -> Option<OsString>) -> Display {
    let set = |name: &str| env(name).is_some_and(|value| !value.is_empty());
    if !cfg!(target_os = "linux") {
        Display::Native
    } else if set("WAYLAND_DISPLAY") {
        Display::Wayland
    } else if set("DISPLAY") {
        Display::X11
    } else {
        Display::None
    }
}

impl Machine {
    /// Examines the machine without changing it.
    pub fn look() -> Self {
        let env = |name: &str| std::env::var_os(name);
        let host = Host {
            root: Path::new("/"),
            env: &env,
        };
        let display = display(&env);
        let linux = cfg!(target_os = "linux");
        Self {
            vulkan: linux.then(|| host.vulkan()),
            // On other systems the compiler comes with the linker that has just built this program.
            cxx: !linux || has_cxx(),
            display,
            window_packages: missing(display, &|library| host.has_library(library)),
            test_window_packages: match linux {
                true => for_tests(&|library| host.has_library(library), &has_program),
                false => Vec::new(),
            },
            face_packages: match linux {
                true => for_faces(&has_file, &works),
                false => Vec::new(),
            },
            installer: if linux {
                installer()
            } else {
                Installer::Unknown
            },
        }
    }
}

fn missing(display: Display, has: &dyn Fn(&str) -> bool) -> Vec<&'static str> {
    let libraries = match display {
        Display::X11 => X11_LIBRARIES,
        Display::Wayland => WAYLAND_LIBRARIES,
        Display::None | Display::Native => &[],
    };
    libraries
        .iter()
        .filter(|(library, _)| !has(library))
        .map(|(_, package)| *package)
        .collect()
}

fn for_tests(
    has_library: &dyn Fn(&str) -> bool,
    has_program: &dyn Fn(&str) -> bool,
) -> Vec<&'static str> {
    let (server, package) = DISPLAY_SERVER;
    let mut missing = missing(Display::X11, has_library);
    if !has_program(server) {
        missing.push(package);
    }
    missing
}

fn for_faces(
    has_file: &dyn Fn(&str) -> bool,
    works: &dyn Fn(&str, &[&str]) -> bool,
) -> Vec<&'static str> {
    let mut missing = Vec::new();
    if !["/usr/include", "/usr/local/include"]
        .iter()
        .any(|folder| has_file(&format!("{folder}/vulkan/vulkan.h")))
    {
        missing.push("libvulkan-dev");
    }
    if !PYTHONS
        .iter()
        .any(|python| works(python, &["-c", PYTHON_TESTS]))
    {
        missing.extend(["python3", "python3-numpy", "python3-pytest"]);
    }
    missing
}

fn has_file(path: &str) -> bool {
    Path::new(path).is_file()
}

/// Whether a program is in the search path.
fn has_program(name: &str) -> bool {
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders).any(|folder| folder.join(name).is_file())
}

/// Whether a program starts and succeeds.
fn works(program: &str, arguments: &[&str]) -> bool {
    Command::new(program)
        .args(arguments)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

/// Whether the compiler that the `cc` crate would call works.
fn has_cxx() -> bool {
    match std::env::var("CXX") {
        // The variable may contain a wrapper or options too.
        Ok(chosen) if !chosen.trim().is_empty() => chosen
            .split_whitespace()
            .next()
            .is_some_and(|program| works(program, &["--version"])),
        _ => works("c++", &["--version"]),
    }
}

fn installer() -> Installer {
    let release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
    if !is_debian_like(&release) || !works("apt-get", &["--version"]) {
        return Installer::Unknown;
    }
    let is_root = Command::new("id")
        .arg("-u")
        .output()
        .is_ok_and(|output| output.stdout.trim_ascii() == b"0");
    if is_root {
        Installer::Apt
    } else if works("sudo", &["-n", "true"]) {
        Installer::AptThroughSudo
    } else {
        Installer::AptForbidden
    }
}

/// Decides by the ID and ID_LIKE lines of os-release(5).
fn is_debian_like(os_release: &str) -> bool {
    os_release
        .lines()
        .filter_map(|line| line.split_once('='))
        .filter(|(key, _)| matches!(*key, "ID" | "ID_LIKE"))
        .flat_map(|(_, value)| value.trim_matches(['"', '\'']).split_whitespace())
        .any(|id| id == "debian" || id == "ubuntu")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tests_need_a_display_server_wherever_they_run() {
        assert_eq!(for_tests(&|_| true, &|_| true), [""; 0]);
        assert_eq!(for_tests(&|_| true, &|_| false), ["xvfb"]);
        let all = for_tests(&|_| false, &|name| name == "Xvfb");
        assert_eq!(all.len(), X11_LIBRARIES.len());
    }

    #[test]
    fn faces_are_tested_by_what_the_machine_has() {
        assert_eq!(for_faces(&|_| true, &|_, _| true), [""; 0]);
        assert_eq!(for_faces(&|_| false, &|_, _| true), ["libvulkan-dev"]);
        let python = ["python3", "python3-numpy", "python3-pytest"];
        assert_eq!(for_faces(&|_| true, &|_, _| false), python);
        // The system's Python is accepted if the first one lacks the packages.
        assert_eq!(
            for_faces(&|_| true, &|python, _| python.starts_with('/')),
            [""; 0]
        );
    }

    #[test]
    fn debian_and_its_children_are_known() {
        assert!(is_debian_like("NAME=\"Debian\"\nID=debian\n"));
        assert!(is_debian_like("ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n"));
        assert!(!is_debian_like("ID=fedora\nVARIANT=debian\n"));
        assert!(!is_debian_like(""));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn an_empty_variable_is_no_display() {
        let env = |pairs: &'static [(&str, &str)]| {
            move |name: &str| {
                pairs
                    .iter()
                    .find(|(key, _)| *key == name)
                    .map(|(_, value)| OsString::from(value))
            }
        };
        assert_eq!(display(&env(&[])), Display::None);
        assert_eq!(display(&env(&[("DISPLAY", "")])), Display::None);
        assert_eq!(display(&env(&[("DISPLAY", ":0")])), Display::X11);
        let both = env(&[("DISPLAY", ":0"), ("WAYLAND_DISPLAY", "wayland-0")]);
        assert_eq!(display(&both), Display::Wayland);
    }

    #[test]
    fn only_what_the_display_opens_is_missed() {
        assert_eq!(missing(Display::None, &|_| false), [""; 0]);
        assert_eq!(missing(Display::X11, &|_| true), [""; 0]);
        assert_eq!(
            missing(Display::X11, &|library| library != "libXi.so.6"),
            ["libxi6"]
        );
        assert!(missing(Display::Wayland, &|_| false).contains(&"libwayland-client0"));
    }
}
