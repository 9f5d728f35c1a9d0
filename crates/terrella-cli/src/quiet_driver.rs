//! A graphics driver that keeps its words to itself.

/// Starts this program again, in its own place, where Mesa would complain of a missing desktop on standard error.
///
/// Mesa's Vulkan looks for a Wayland session to put the display's adapter first, and Wayland's library prints an error
/// where `XDG_RUNTIME_DIR` is not set: services, containers, ssh. Adapters are ranked here anyway, so the layer that does
/// this is switched off there. Its switch is a variable of the environment, which a running program cannot set for itself.
/// Whoever chooses an adapter by Mesa's own variables keeps the layer, and its message.
#[cfg(target_os = "linux")]
pub fn quieten() {
    use std::os::unix::process::CommandExt;
    const SWITCH: &str = "NODEVICE_SELECT";
    const SPEAK_FOR_IT: [&str; 5] = [
        SWITCH,
        "XDG_RUNTIME_DIR",
        "WAYLAND_DISPLAY",
        "MESA_VK_DEVICE_SELECT",
        "DRI_PRIME",
    ];
    if SPEAK_FOR_IT
        .iter()
        .any(|name| std::env::var_os(name).is_some())
    {
        return;
    }
    let mut arguments = std::env::args_os();
    if let (Ok(program), Some(own_name)) = (std::env::current_exe(), arguments.next()) {
        let error = std::process::Command::new(program)
            .arg0(own_name)
            .args(arguments)
            .env(SWITCH, "1")
            .exec();
        // It goes on as it is, with the message.
        tracing::debug!("the program cannot be started again: {error}");
    }
}

/// Nothing to do: Mesa's layer is Linux's.
#[cfg(not(target_os = "linux"))]
pub fn quieten() {}
