//! Programs in C and C++, built by the machine's compiler against the shared library and run, plain and under AddressSanitizer. Without a C
//! compiler they are skipped with a message.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// The folder where cargo put the shared library of this test.
fn library_folder() -> PathBuf {
    let this = std::env::current_exe().expect("this program");
    let folder = this.parent().expect("a folder").to_owned();
    assert!(
        folder.join("libterrella_c.so").is_file(),
        "no libterrella_c.so in {}",
        folder.display()
    );
    folder
}

fn has(compiler: &str) -> bool {
    let there = Command::new(compiler).arg("--version").output().is_ok();
    if !there {
        eprintln!(
            "SKIPPED: there is no {compiler}; `cargo xtask prepare` installs it where it can"
        );
    }
    there
}

fn has_vulkan_headers() -> bool {
    let there = ["/usr/include", "/usr/local/include"]
        .iter()
        .any(|folder| Path::new(folder).join("vulkan/vulkan.h").is_file());
    if !there {
        eprintln!(
            "SKIPPED: there are no headers of Vulkan; `cargo xtask prepare` installs them where it can"
        );
    }
    there
}

struct Build<'b> {
    source: &'b str,
    arguments: &'b [&'b str],
    libraries: &'b [&'b str],
    name: &'b str,
}

/// Compiles a program and returns its path.
fn build(build: &Build<'_>, out: &Path) -> PathBuf {
    let (libraries, program) = (library_folder(), out.join(build.name));
    let cpp = build.source.ends_with(".cpp");
    let mut command = Command::new(if cpp { "g++" } else { "gcc" });
    command
        .args([if cpp { "-std=c++17" } else { "-std=c11" }, "-pedantic"])
        .args(["-Wall", "-Wextra", "-Werror", "-O1", "-g"])
        .args(build.arguments)
        .arg("-I")
        .arg(folder().join("include"))
        .arg(folder().join(build.source))
        .arg("-o")
        .arg(&program)
        .arg("-L")
        .arg(&libraries)
        .arg("-lterrella_c")
        .args(build.libraries);
    let output = command.output().expect("the compiler runs");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    // The file name of the installed library.
    let named = out.join(env!("TERRELLA_SONAME"));
    if !named.exists() {
        std::fs::copy(libraries.join("libterrella_c.so"), named).expect("copied");
    }
    program
}

fn run(program: &Path, out: &Path, arguments: &[&Path]) -> Output {
    let root = folder().join("../..");
    let output = Command::new(program)
        .args(arguments)
        .env("LD_LIBRARY_PATH", out)
        .env("TERRELLA_TEXTURES", root.join("textures"))
        // Memory that drivers keep until exit is not ours.
        .env("ASAN_OPTIONS", "detect_leaks=0:abort_on_error=0")
        .output()
        .expect("the program runs");
    assert!(
        output.status.success(),
        "{}: {}\n{}{}",
        program.display(),
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

fn picture(path: &Path) -> image::RgbImage {
    image::open(path).expect("a picture").to_rgb8()
}

/// Mean difference of two images, in steps of 8 bits.
fn difference(one: &image::RgbImage, other: &image::RgbImage) -> f64 {
    assert_eq!(one.dimensions(), other.dimensions());
    let steps = one.as_raw().iter().zip(other.as_raw());
    let sum: u64 = steps.map(|(a, b)| u64::from(a.abs_diff(*b))).sum();
    sum as f64 / one.as_raw().len() as f64
}

#[test]
fn examples_draw_the_same_earth() {
    if !has("gcc") || !has("g++") {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let still = Build {
        source: "examples/still.c",
        arguments: &[],
        libraries: &[],
        name: "still",
    };
    let png = out.path().join("still.png");
    run(&build(&still, out.path()), out.path(), &[&png]);
    let drawn = picture(&png);
    // The centre shows the Earth, and the image is not nearly black.
    let [red, green, blue] = drawn.get_pixel(320, 250).0.map(u32::from);
    assert!(red + green + blue > 60, "{red} {green} {blue}");

    let scene = Build {
        source: "examples/scene.cpp",
        arguments: &[],
        libraries: &[],
        name: "scene",
    };
    let iss = out.path().join("iss.png");
    let file = folder().join("../../config/iss.toml");
    let reported = run(&build(&scene, out.path()), out.path(), &[&file, &iss]);
    let reported = String::from_utf8_lossy(&reported.stdout);
    assert!(
        reported.contains("Z: the lowest line's middle shows "),
        "{reported}"
    );
    assert_eq!(picture(&iss).dimensions(), (640, 360));

    if !has_vulkan_headers() {
        return;
    }
    let host = Build {
        source: "examples/host_vulkan.c",
        arguments: &[],
        libraries: &["-lvulkan", "-lm"],
        name: "host_vulkan",
    };
    let vulkan = out.path().join("vulkan.png");
    run(&build(&host, out.path()), out.path(), &[&vulkan]);
    // The same view with one sample per pixel instead of four: only edges differ.
    let off = difference(&drawn, &picture(&vulkan));
    assert!(off < 1.0, "{off}");
    // Drawn into memory that another process owns: every byte is the same.
    for (name, arguments) in [
        ("share_vulkan", &[][..]),
        ("share_vulkan_asan", &["-fsanitize=address,undefined"][..]),
    ] {
        let share = Build {
            source: "examples/share_vulkan.c",
            arguments,
            libraries: &["-lvulkan", "-lm"],
            name,
        };
        let shared = out.path().join(name).with_extension("png");
        run(&build(&share, out.path()), out.path(), &[&shared]);
        assert_eq!(picture(&shared), picture(&vulkan), "{name}");
    }
}

#[test]
fn misuse_is_a_status_under_the_sanitizer() {
    if !has("gcc") {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let scene = folder().join("../../config/iss.toml");
    for (name, arguments) in [
        ("misuse", &[][..]),
        ("misuse_asan", &["-fsanitize=address,undefined"][..]),
    ] {
        let program = Build {
            source: "tests/c/misuse.c",
            arguments,
            libraries: &["-lpthread"],
            name,
        };
        run(&build(&program, out.path()), out.path(), &[&scene]);
    }
}

#[test]
fn classes_of_cpp_throw_and_free() {
    if !has("g++") {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let program = Build {
        source: "tests/c/raii.cpp",
        arguments: &["-O0"],
        libraries: &[],
        name: "raii",
    };
    let orbit = folder().join("../../config/orbits/iss.tle");
    run(&build(&program, out.path()), out.path(), &[&orbit]);
}

#[test]
fn the_class_for_vulkan_draws_and_throws() {
    if !has("g++") || !has_vulkan_headers() {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let program = Build {
        source: "tests/c/vulkan.cpp",
        arguments: &["-fsanitize=address,undefined"],
        libraries: &["-lvulkan"],
        name: "vulkan_class",
    };
    run(&build(&program, out.path()), out.path(), &[]);
}

#[test]
fn the_classes_name_the_cpp_that_they_need() {
    if !has("g++") {
        return;
    }
    let checked = |standard: &str| {
        let mut command = Command::new("g++");
        command.args(["-x", "c++", "-fsyntax-only", standard]);
        let header = folder().join("include/terrella.hpp");
        command.arg(header).output().expect("the compiler runs")
    };
    let old = checked("-std=c++14");
    let words = String::from_utf8_lossy(&old.stderr);
    assert!(
        !old.status.success() && words.contains("needs C++17"),
        "{words}"
    );
    let new = checked("-std=c++17");
    let words = String::from_utf8_lossy(&new.stderr);
    assert!(new.status.success(), "{words}");
}

#[test]
fn examples_are_clean_under_the_sanitizer() {
    if !has("gcc") || !has("g++") {
        return;
    }
    let out = tempfile::tempdir().expect("a folder");
    let scene = folder().join("../../config/iss.toml");
    let png = out.path().join("picture.png");
    for (source, name, arguments) in [
        ("examples/still.c", "still_asan", vec![png.as_path()]),
        (
            "examples/scene.cpp",
            "scene_asan",
            vec![scene.as_path(), png.as_path()],
        ),
    ] {
        let program = Build {
            source,
            arguments: &["-fsanitize=address,undefined"],
            libraries: &[],
            name,
        };
        run(&build(&program, out.path()), out.path(), &arguments);
    }
}

#[test]
fn the_page_shows_the_example() {
    let read = |path: &str| {
        let path = folder().join(path);
        std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    let page = read("../../docs/embedding/c.md");
    assert!(page.contains(&format!("```c\n{}```", read("examples/still.c"))));
    assert!(page.contains(&format!("```cpp\n{}```", read("examples/scene.cpp"))));
}
