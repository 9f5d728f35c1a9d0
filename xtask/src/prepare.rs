//! Prepares the machine for building and drawing: finds missing packages and installs them if permitted.

use crate::machine::{Display, Installer, Machine};
use crate::process::{self, ChildFailed, say};
use crate::vulkan::Vulkan;
use anyhow::bail;
use std::path::Path;
use std::process::Command;

/// Whether packages may be installed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Policy {
    /// Only without a question to the user: as root, or if `sudo` needs no password.
    IfAllowed,
    /// Never.
    Never,
}

/// Whether a window will be opened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// If there is a display.
    IfDisplay,
    /// By the tests, on their own display server.
    ForTests,
    /// Never.
    Never,
}

/// A software graphics adapter, and the loader that finds it.
const GRAPHICS: &[&str] = &["libvulkan1", "mesa-vulkan-drivers"];

/// The required action.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Plan {
    /// Everything is installed.
    Nothing,
    /// Install these packages.
    Install(Vec<&'static str>),
    /// These packages are missing and must be installed by the user. `stops` if nothing works without them.
    Ask {
        packages: Vec<&'static str>,
        stops: bool,
    },
}

fn plan(machine: &Machine, policy: Policy, window: Window) -> Plan {
    let mut needed = Vec::new();
    if !machine.cxx {
        needed.push("g++");
    }
    if machine
        .vulkan
        .as_ref()
        .is_some_and(|v| v.usable().is_empty())
    {
        needed.extend(GRAPHICS);
    }
    // Images and video need no window, so missing window libraries alone stop nothing.
    let stops = !needed.is_empty();
    needed.extend(match window {
        Window::IfDisplay => &machine.window_packages[..],
        Window::ForTests => &machine.test_window_packages[..],
        Window::Never => &[],
    });
    if window == Window::ForTests {
        needed.extend(&machine.face_packages);
    }
    let allowed = matches!(
        machine.installer,
        Installer::Apt | Installer::AptThroughSudo
    );
    if needed.is_empty() {
        Plan::Nothing
    } else if policy == Policy::IfAllowed && allowed {
        Plan::Install(needed)
    } else {
        Plan::Ask {
            packages: needed,
            stops,
        }
    }
}

/// The request to the user.
fn advice(installer: Installer, packages: &[&str]) -> String {
    let list = packages.join(" ");
    match installer {
        Installer::Apt => {
            format!("apt-get update && apt-get install -y --no-install-recommends {list}")
        }
        Installer::AptThroughSudo | Installer::AptForbidden => {
            format!("sudo apt-get update && sudo apt-get install -y --no-install-recommends {list}")
        }
        Installer::Unknown => format!(
            "install with your system's package manager what Debian calls: {list} \
             (the software Vulkan driver is `mesa-vulkan-drivers` on Fedora and `vulkan-swrast` on Arch)"
        ),
    }
}

/// Examines the machine and installs missing packages, or explains how to.
pub fn run(policy: Policy, window: Window) -> anyhow::Result<()> {
    let machine = Machine::look();
    describe(&machine);
    match plan(&machine, policy, window) {
        Plan::Nothing => Ok(()),
        Plan::Install(packages) => {
            install(machine.installer, &packages)?;
            let now = Machine::look();
            describe(&now);
            match plan(&now, Policy::Never, Window::Never) {
                Plan::Ask { packages, .. } => bail!(
                    "{} installed without an error, and what they bring is still not found",
                    packages.join(" ")
                ),
                _ => Ok(()),
            }
        }
        Plan::Ask { packages, stops } => {
            let why = match policy {
                Policy::Never => "--no-install was given",
                Policy::IfAllowed => "this needs rights that I do not have",
            };
            let advice = advice(machine.installer, &packages);
            if stops {
                bail!("packages are missing ({why}). Run this, then try again:\n  {advice}");
            }
            say(format_args!(
                "some of what runs on a machine with more is left out: windows, or tests of the C and Python packages ({why}). To have it, run: {advice}"
            ));
            Ok(())
        }
    }
}

fn describe(machine: &Machine) {
    match &machine.vulkan {
        Some(vulkan) => say(format_args!("graphics: {}", graphics(vulkan))),
        None => say("graphics: this system brings its own"),
    }
    if !machine.cxx {
        say("compiler: no C++ compiler");
    }
    if machine.display != Display::None && !machine.window_packages.is_empty() {
        let list = machine.window_packages.join(" ");
        say(format_args!("window: missing {list}"));
    }
}

fn graphics(vulkan: &Vulkan) -> String {
    let list = |drivers: Vec<String>| drivers.join(", ");
    let usable = vulkan.usable();
    if !usable.is_empty() {
        let names = usable.iter().map(|driver| driver.to_string()).collect();
        format!("Vulkan driver {}", list(names))
    } else if !vulkan.loader {
        "no Vulkan loader".into()
    } else if vulkan.drivers.is_empty() {
        "no Vulkan driver".into()
    } else {
        let names = vulkan
            .drivers
            .iter()
            .map(|driver| driver.to_string())
            .collect();
        format!("no Vulkan driver that can be used: {}", list(names))
    }
}

fn root_command(installer: Installer, program: &str) -> Command {
    let mut command = match installer {
        Installer::AptThroughSudo => {
            let mut command = Command::new("sudo");
            command.args(["-n", "env"]);
            command
        }
        _ => Command::new("env"),
    };
    // On the command line, because sudo clears the environment.
    command.args(["DEBIAN_FRONTEND=noninteractive", program]);
    command
}

fn install(installer: Installer, packages: &[&str]) -> anyhow::Result<()> {
    let update = || process::run(root_command(installer, "apt-get").args(["-q", "update"]));
    let install = || {
        process::run(
            root_command(installer, "apt-get")
                // Another package tool may be running, as just after a machine's start.
                .args(["-q", "-o", "DPkg::Lock::Timeout=120"])
                .args(["install", "-y", "--no-install-recommends"])
                .args(packages),
        )
    };
    let known = Command::new("apt-cache")
        .arg("show")
        .args(packages)
        .output()
        .is_ok_and(|output| output.status.success());
    if !known {
        say("the package list does not name what is needed: it is fetched again");
        update()?;
        return install();
    }
    install().or_else(|_| {
        say("the package list may be out of date: it is fetched again");
        update()?;
        install()
    })
}

/// Opens the adapter with the program itself. If that fails, installs the software driver and tries once more.
///
/// A driver with a device can still be unusable: too old, or without required features.
pub fn check_adapter(policy: Policy, terrella: &Path) -> anyhow::Result<()> {
    let doctor = || -> anyhow::Result<()> {
        let mut command = Command::new(terrella);
        command.arg("doctor");
        let what = process::shown(&command);
        say(&what);
        let output = command.output()?;
        if output.status.success() {
            return Ok(());
        }
        eprint!("{}", String::from_utf8_lossy(&output.stdout));
        eprint!("{}", String::from_utf8_lossy(&output.stderr));
        Err(ChildFailed::new(what, output.status).into())
    };
    let Err(error) = doctor() else {
        return Ok(());
    };
    let machine = Machine::look();
    let software = machine
        .vulkan
        .as_ref()
        .is_none_or(|vulkan| vulkan.has_software());
    let allowed = matches!(
        machine.installer,
        Installer::Apt | Installer::AptThroughSudo
    );
    if software {
        return Err(error);
    }
    if policy == Policy::Never || !allowed {
        let advice = advice(machine.installer, GRAPHICS);
        return Err(error.context(format!(
            "no adapter can be used; a software one may help. Run this, then try again:\n  {advice}\n"
        )));
    }
    install(machine.installer, GRAPHICS)?;
    doctor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vulkan::Driver;

    fn vulkan(software: bool) -> Vulkan {
        let driver = Driver {
            name: "lvp".into(),
            software: true,
            problem: None,
        };
        Vulkan {
            loader: true,
            drivers: if software { vec![driver] } else { Vec::new() },
        }
    }

    fn machine() -> Machine {
        Machine {
            vulkan: Some(vulkan(true)),
            cxx: true,
            display: Display::None,
            window_packages: Vec::new(),
            test_window_packages: Vec::new(),
            face_packages: Vec::new(),
            installer: Installer::Apt,
        }
    }

    fn fresh() -> Machine {
        Machine {
            vulkan: Some(vulkan(false)),
            cxx: false,
            ..machine()
        }
    }

    #[test]
    fn a_ready_machine_is_left_alone() {
        for policy in [Policy::IfAllowed, Policy::Never] {
            assert_eq!(plan(&machine(), policy, Window::IfDisplay), Plan::Nothing);
        }
    }

    #[test]
    fn a_fresh_machine_gets_compiler_and_driver() {
        let expected = Plan::Install(vec!["g++", "libvulkan1", "mesa-vulkan-drivers"]);
        assert_eq!(
            plan(&fresh(), Policy::IfAllowed, Window::IfDisplay),
            expected
        );
    }

    #[test]
    fn nothing_is_installed_without_leave() {
        let never = plan(&fresh(), Policy::Never, Window::IfDisplay);
        assert!(matches!(never, Plan::Ask { stops: true, .. }), "{never:?}");
        for installer in [Installer::AptForbidden, Installer::Unknown] {
            let machine = Machine {
                installer,
                ..fresh()
            };
            let plan = plan(&machine, Policy::IfAllowed, Window::IfDisplay);
            assert!(matches!(plan, Plan::Ask { stops: true, .. }), "{plan:?}");
        }
    }

    #[test]
    fn window_libraries_stop_nothing_and_only_count_with_a_window() {
        let machine = Machine {
            display: Display::X11,
            window_packages: vec!["libxi6"],
            ..machine()
        };
        assert_eq!(
            plan(&machine, Policy::IfAllowed, Window::IfDisplay),
            Plan::Install(vec!["libxi6"])
        );
        assert_eq!(
            plan(&machine, Policy::Never, Window::IfDisplay),
            Plan::Ask {
                packages: vec!["libxi6"],
                stops: false
            }
        );
        assert_eq!(
            plan(&machine, Policy::IfAllowed, Window::Never),
            Plan::Nothing
        );
    }

    #[test]
    fn tests_get_a_display_server_where_a_display_is_or_is_not() {
        let machine = Machine {
            test_window_packages: vec!["xvfb"],
            ..machine()
        };
        assert_eq!(
            plan(&machine, Policy::IfAllowed, Window::ForTests),
            Plan::Install(vec!["xvfb"])
        );
        let never = plan(&machine, Policy::Never, Window::ForTests);
        assert!(matches!(never, Plan::Ask { stops: false, .. }), "{never:?}");
        let other = plan(&machine, Policy::IfAllowed, Window::IfDisplay);
        assert_eq!(other, Plan::Nothing);
    }

    #[test]
    fn a_system_with_its_own_graphics_needs_no_driver() {
        let machine = Machine {
            vulkan: None,
            installer: Installer::Unknown,
            ..machine()
        };
        assert_eq!(
            plan(&machine, Policy::IfAllowed, Window::IfDisplay),
            Plan::Nothing
        );
    }

    #[test]
    fn the_advice_can_be_pasted() {
        assert_eq!(
            advice(Installer::AptForbidden, &["g++"]),
            "sudo apt-get update && sudo apt-get install -y --no-install-recommends g++"
        );
        assert!(advice(Installer::Apt, &["g++"]).starts_with("apt-get update"));
        assert!(advice(Installer::Unknown, &["g++"]).contains("g++"));
    }

    #[test]
    fn the_environment_reaches_apt_through_sudo() {
        let command = root_command(Installer::AptThroughSudo, "apt-get");
        assert_eq!(
            process::shown(&command),
            "sudo -n env DEBIAN_FRONTEND=noninteractive apt-get"
        );
        let command = root_command(Installer::Apt, "apt-get");
        assert_eq!(
            process::shown(&command),
            "env DEBIAN_FRONTEND=noninteractive apt-get"
        );
    }
}
