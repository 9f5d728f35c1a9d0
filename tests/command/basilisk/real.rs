//! The real simulator, if Python has it: the page's own script, unchanged, and a camera.
//!
//! `TERRELLA_BASILISK_PYTHON` names the interpreter, by default `python3`. Without `bsk` these tests are skipped with a message.

use super::scene;
use crate::{Place, frame_names};
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Scripts look for their viewer on one port: one test at a time.
static PORT: Mutex<()> = Mutex::new(());

/// The interpreter that has Basilisk.
fn python() -> Option<String> {
    let python = std::env::var("TERRELLA_BASILISK_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let found = Command::new(&python)
        .args(["-c", "import Basilisk.simulation.spacecraft"])
        .output();
    match found.is_ok_and(|output| output.status.success()) {
        true => Some(python),
        false => {
            eprintln!(
                "SKIPPED: {python} has no Basilisk; pip install bsk==2.12.1 numpy, and name the interpreter by TERRELLA_BASILISK_PYTHON"
            );
            None
        }
    }
}

/// A program that is ended with the test.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The first script of the page.
fn page_script() -> String {
    let page = include_str!("../../../docs/basilisk.md");
    let (_, script) = page.split_once("```python\n").expect("a script");
    script.split_once("```").expect("its end").0.to_owned()
}

fn run(place: &Place, python: &str, name: &str, script: &str) -> Child {
    place.scene(name, script);
    let mut command = Command::new(python);
    command.arg(name).current_dir(place.path("."));
    command.stdout(Stdio::piped()).spawn().expect("starts")
}

#[test]
fn the_script_of_the_page_is_filmed_unchanged() {
    let Some(python) = python() else { return };
    let _one = PORT.lock();
    let place = Place::new();
    let text = scene("trail = true\nmarker = true", "mode = \"chase\"");
    place.scene(
        "basilisk.toml",
        &text.replace("duration_s = 1000", "duration_s = 6"),
    );
    let _simulator = Ended(run(&place, &python, "leo.py", &page_script()));
    let output = place.succeed(&["play", "basilisk.toml", "--frames", "frames"]);
    assert_eq!(frame_names(&place.path("frames")).len(), 6);
    let said = crate::words(&output);
    for reported in ["does not turn the Earth", "has no Sun"] {
        assert!(said.contains(reported), "{said}");
    }
}

/// The page's script with a camera and without a display; it writes what comes back.
fn camera_script() -> String {
    let camera = r#"
import ctypes, numpy as np
cam, cam_msg = vizSupport.createCameraConfigMsg(viz, cameraID=1, parentName="sat-1", fieldOfView=np.radians(60.0),
    resolution=[96, 64], cameraPos_B=[0.0, 0.0, 1.0], sigma_CB=[0.0, 0.0, 0.0], renderRate=20.0)
cam.isOn = 1
cam_msg.write(cam)
sim.InitializeSimulation()
for k in range(1, 6):
    sim.ConfigureStopTime(macros.sec2nano(20.0 * k))
    sim.ExecuteSimulation()
    msg = viz.opnavImageOutMsgs[0].read()
    data = ctypes.string_at(int(msg.imagePointer), msg.imageBufferLength) if msg.valid else b""
    open("camera_%d.png" % k, "wb").write(data)
print("done")
"#;
    let page = page_script().replace("liveStream=True", "noDisplay=True");
    let (before, _) = page
        .split_once("sim.InitializeSimulation()")
        .expect("its start");
    before.replace("clock.accelFactor = 60.0", "clock.accelFactor = 6000.0") + camera
}

#[test]
fn a_camera_is_answered_without_a_display() {
    let Some(python) = python() else { return };
    let _one = PORT.lock();
    let place = Place::new();
    place.scene(
        "basilisk.toml",
        &scene("timeout_s = 60", "mode = \"chase\""),
    );
    let simulator = run(&place, &python, "camera.py", &camera_script());
    let output = place.succeed(&["serve", "basilisk.toml", "--once"]);
    let done = simulator.wait_with_output().expect("ends");
    assert!(done.status.success() && done.stdout.ends_with(b"done\n"));
    for k in 1..=5 {
        let picture = image::open(place.path(&format!("camera_{k}.png"))).expect("a picture");
        assert_eq!((picture.width(), picture.height()), (96, 64));
    }
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        said.contains("5 images") && said.contains("0 requested and not rendered"),
        "{said}"
    );
}

/// Viewers come and go in the middle of a simulation, ended by a signal each; it never notices.
#[cfg(unix)]
#[test]
fn a_simulation_outlives_its_viewers() {
    let Some(python) = python() else { return };
    let _one = PORT.lock();
    let place = Place::new();
    place.scene("basilisk.toml", &scene("", "mode = \"chase\""));
    let script = page_script().replace("sim.AddModelToTask(\"task\", clock)", "");
    let script = script.replace("macros.min2nano(95)", "macros.min2nano(60000)");
    let mut simulator = Ended(run(&place, &python, "leo.py", &script));
    let begun = Instant::now();
    let mut viewers = 0;
    while simulator.0.try_wait().expect("asks").is_none() {
        assert!(
            begun.elapsed() < Duration::from_secs(200),
            "it hangs after {viewers} viewers"
        );
        let arguments = ["serve", "basilisk.toml", "--once", "-q"];
        let mut viewer = Ended(
            place
                .command(&arguments)
                .stdout(Stdio::null())
                .spawn()
                .expect("starts"),
        );
        if viewers < 12 {
            std::thread::sleep(Duration::from_millis(700));
            let signal = if viewers % 2 == 0 { "-INT" } else { "-TERM" };
            let id = viewer.0.id().to_string();
            Command::new("kill")
                .args([signal, &id])
                .status()
                .expect("signals");
        }
        let ended = viewer.0.wait().expect("ends");
        assert!(matches!(ended.code(), Some(0 | 130 | 143)), "{ended}");
        viewers += 1;
    }
    println!("{viewers} viewers, {:?}", begun.elapsed());
    assert!(viewers >= 12, "it ended before {viewers}");
}
