//! Archives are complete, and their contents work in a folder without any other files.

use super::*;
use std::fs::File;

/// A substitute for the program that prints the expected texts.
const STAND_IN: &str = "case \"$1 $2\" in
'man --list') echo play; echo 'pack build';;
'man '*) echo \".TH $3\";;
'completions '*) echo \"# $2\";;
*) exit 2;;
esac";

/// Runs a script through the shell: a parallel test may have the file open for writing.
fn by_shell(script: &Path) -> Command {
    let mut command = Command::new("sh");
    command.arg(script);
    command
}

fn extract(archive: &Path, to: &Path) {
    let packed = flate2::read::GzDecoder::new(File::open(archive).unwrap());
    tar::Archive::new(packed).unpack(to).unwrap();
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    names
}

#[cfg(unix)]
#[test]
fn an_archive_has_all_that_the_program_needs() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let (script, out) = (folder.path().join("terrella.sh"), folder.path().join("out"));
    fs::write(&script, STAND_IN).unwrap();
    pack_program(&script, &by_shell, &out).unwrap();
    write_checksums(&out).unwrap();

    let name = versioned("terrella").unwrap();
    let archive = format!("{name}.tar.gz");
    assert_eq!(names(&out), [CHECKSUMS, archive.as_str()]);
    let sums = fs::read_to_string(out.join(CHECKSUMS)).unwrap();
    let sum = archive::sha256(&out.join(&archive)).unwrap();
    assert_eq!(sums, format!("{sum}  {archive}\n"));

    let empty = tempfile::tempdir().unwrap();
    extract(&out.join(&archive), empty.path());
    assert_eq!(names(empty.path()), [name.as_str()]);
    let prefix = empty.path().join(&name);
    let program = layout::program_below(&prefix);
    assert_eq!(fs::read_to_string(&program).unwrap(), STAND_IN);
    let mode = fs::metadata(&program).unwrap().permissions().mode();
    assert_eq!(mode & 0o777, 0o755);
    let text = |file: &str| {
        let path = prefix.join("share").join(file);
        fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    assert_eq!(text("bash-completion/completions/terrella"), "# bash\n");
    assert_eq!(text("zsh/site-functions/_terrella"), "# zsh\n");
    assert_eq!(text("man/man1/terrella.1"), ".TH \n");
    assert_eq!(text("man/man1/terrella-pack-build.1"), ".TH build\n");
    assert!(text("doc/terrella/LICENSE-MIT").contains("MIT"));
    let readme = fs::read_to_string(prefix.join("README.md")).unwrap();
    assert_eq!(readme, layout::PROGRAM_README);
    assert_eq!(text("doc/terrella/README.md"), readme);
    // A source checkout's commands do not work here.
    assert!(!readme.contains("cargo"), "{readme}");
    assert!(text("terrella/config/iss.toml").contains("orbits/iss.tle"));
    assert!(text("terrella/textures/SOURCES.md").contains("NASA"));
    let maps = names(&prefix.join(layout::MAPS));
    for map in [
        "day.jpg",
        "clouds.jpg",
        "elevation.toml",
        "stars.bin",
        "dem",
    ] {
        assert!(maps.iter().any(|name| name == map), "no {map}: {maps:?}");
    }
    for other in ["Cargo.toml", "lib.rs"] {
        assert!(!maps.iter().any(|name| name == other), "{other}");
    }

    // The same input gives the same archive.
    let again = folder.path().join("again");
    pack_program(&script, &by_shell, &again).unwrap();
    assert_eq!(archive::sha256(&again.join(&archive)).unwrap(), sum);
}

#[cfg(unix)]
#[test]
fn a_program_that_fails_leaves_no_archive() {
    let folder = tempfile::tempdir().unwrap();
    let (script, out) = (folder.path().join("terrella.sh"), folder.path().join("out"));
    for broken in ["exit 3", "true"] {
        fs::write(&script, broken).unwrap();
        pack_program(&script, &by_shell, &out).unwrap_err();
        assert!(!out.exists());
    }
}

#[test]
fn a_program_that_is_too_large_is_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let large = folder.path().join("terrella");
    File::create(&large)
        .and_then(|file| file.set_len(MAX_PROGRAM_BYTES + 1))
        .unwrap();
    let error = pack_program(&large, &by_shell, folder.path()).unwrap_err();
    assert!(error.to_string().contains("36000001 bytes"), "{error}");
}

#[cfg(unix)]
#[test]
fn links_stay_links() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (folder.path().join("a"), folder.path().join("b"));
    fs::create_dir(&from).unwrap();
    fs::write(from.join("x.so.0"), "library").unwrap();
    std::os::unix::fs::symlink("x.so.0", from.join("x.so")).unwrap();
    let path = folder.path().join("a.tar.gz");
    archive::write(&from, "a", &path).unwrap();
    extract(&path, &to);
    assert_eq!(
        fs::read_link(to.join("a/x.so")).unwrap(),
        Path::new("x.so.0")
    );
}

#[test]
fn checksums_are_those_of_the_standard() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("abc");
    fs::write(&path, "abc").unwrap();
    // FIPS 180-4, the example of one block.
    let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
    assert_eq!(archive::sha256(&path).unwrap(), expected);
}

/// Draws a first image with the files of a release, in an empty folder and with an empty environment. Builds the program, which takes many minutes;
/// `TERRELLA_PROGRAM` names an existing one.
#[test]
#[ignore = "builds a release; run by `.ci/run --always`, or by hand"]
fn the_archived_program_draws_a_first_picture() {
    let folder = tempfile::tempdir().unwrap();
    let program = std::env::var_os("TERRELLA_PROGRAM").map(PathBuf::from);
    run(&[Part::Program], program, folder.path()).unwrap();
    let name = versioned("terrella").unwrap();
    let empty = tempfile::tempdir().unwrap();
    extract(&folder.path().join(format!("{name}.tar.gz")), empty.path());
    let prefix = empty.path().join(&name);
    let terrella = |arguments: &[&str]| {
        let mut command = Command::new(layout::program_below(&prefix));
        command.args(arguments).current_dir(empty.path());
        let output = command
            .env_clear()
            .env("HOME", empty.path())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{arguments:?}: {said}");
        String::from_utf8(output.stdout).unwrap() + &said
    };
    assert!(terrella(&["--version"]).contains(env!("CARGO_PKG_VERSION")));
    let said = terrella(&["frame", "-o", "iss.png", "--size", "640x360"]);
    assert!(said.starts_with("iss.png: 640 × 360 pixels"), "{said}");
    let picture = image::open(empty.path().join("iss.png")).unwrap();
    let bright = picture
        .to_luma8()
        .pixels()
        .filter(|one| one.0[0] > 60)
        .count();
    assert!(bright > 640 * 360 / 10, "{bright} pixels are bright");
    for block in layout::PROGRAM_README.split("```sh\n").skip(1) {
        let mut shell = Command::new("bash");
        let block = block.split_once("```").unwrap().0;
        shell.args(["-e", "-c", block]).current_dir(&prefix);
        let path = format!("{}/bin:/usr/bin:/bin", prefix.display());
        let ran = shell
            .env_clear()
            .env("HOME", empty.path())
            .env("PATH", path);
        assert!(ran.status().unwrap().success(), "{block}");
    }
    let scene = prefix.join("share/terrella/config/relief.toml");
    let scene = scene.to_str().unwrap();
    terrella(&["frame", scene, "-o", "relief.png", "--size", "64x36"]);
    // A missing scene is answered with one that is installed.
    let mut missing = Command::new(layout::program_below(&prefix));
    let missing = missing
        .args(["check", "config/iss.toml"])
        .current_dir(empty.path());
    let said = String::from_utf8(missing.output().unwrap().stderr).unwrap();
    assert!(said.contains("share/terrella/config/iss.toml"), "{said}");
    // It uses its own maps, not those of the checkout that it was built in.
    fs::remove_file(prefix.join(layout::MAPS).join("clouds.jpg")).unwrap();
    assert!(terrella(&["check"]).contains("missing, so left out"));
}

/// Compiles a program by pkg-config and by CMake with the files of a release, in an empty folder, and draws with it. `TERRELLA_C_LIBRARY` names a
/// folder with an installed library, instead of a build.
#[test]
#[ignore = "builds a release; run by `.ci/run --always`, or by hand"]
fn the_archived_c_library_draws_a_first_picture() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let empty = tempfile::tempdir().unwrap();
    let prefix = match std::env::var_os("TERRELLA_C_LIBRARY") {
        Some(installed) => PathBuf::from(installed),
        None => {
            let folder = tempfile::tempdir().unwrap();
            run(&[Part::CLibrary], None, folder.path()).unwrap();
            let name = versioned("terrella-c").unwrap();
            extract(&folder.path().join(format!("{name}.tar.gz")), empty.path());
            empty.path().join(&name)
        }
    };
    let source = repository_root().join("crates/terrella-c/examples/still.c");
    let draws = |program: &Path, png: &str| {
        let mut drawn = Command::new(program);
        drawn.env("LD_LIBRARY_PATH", prefix.join("lib"));
        // The shared library finds the maps beside itself.
        match program.to_string_lossy().contains("static") {
            true => drawn.env("TERRELLA_TEXTURES", prefix.join(layout::MAPS)),
            false => drawn.env_remove("TERRELLA_TEXTURES"),
        };
        let drawn = drawn.arg(png).current_dir(empty.path());
        assert!(drawn.status().unwrap().success(), "{}", program.display());
        let picture = image::open(empty.path().join(png)).unwrap();
        assert_eq!((picture.width(), picture.height()), (640, 360));
    };
    let asked = |arguments: &[&str]| {
        let mut command = Command::new("pkg-config");
        command.env("PKG_CONFIG_PATH", prefix.join("lib/pkgconfig"));
        let output = command.args(arguments).arg("terrella").output().unwrap();
        assert!(output.status.success(), "{arguments:?}");
        String::from_utf8(output.stdout).unwrap()
    };
    assert_eq!(asked(&["--modversion"]).trim(), env!("CARGO_PKG_VERSION"));
    let private = asked(&["--libs-only-l", "--static"]).replace("-lterrella_c", "");
    let archive = prefix.join("lib/libterrella_c.a").display().to_string();
    let shared = asked(&["--cflags", "--libs"]);
    let only_header = asked(&["--cflags"]) + &archive + " " + &private;
    for (program, arguments) in [("shared", shared), ("static", only_header)] {
        let mut compiler = Command::new("cc");
        compiler.arg(&source).args(arguments.split_whitespace());
        let compiled = compiler.args(["-o", program]).current_dir(empty.path());
        assert!(compiled.status().unwrap().success(), "{program}");
        draws(&empty.path().join(program), &format!("{program}.png"));
    }

    let has_cmake = Command::new("cmake").arg("--version").output().is_ok();
    if !has_cmake {
        eprintln!("SKIPPED: there is no cmake; `python3 -m pip install cmake` has it");
        return;
    }
    let page = fs::read_to_string(repository_root().join("docs/embedding/c.md")).unwrap();
    let lists = fenced(&page, "cmake");
    for (name, lists) in [
        ("by_cmake", lists.to_owned()),
        (
            "by_cmake_static",
            lists.replace("terrella::terrella", "terrella::static"),
        ),
    ] {
        let project = empty.path().join(name);
        fs::create_dir(&project).unwrap();
        fs::copy(&source, project.join("still.c")).unwrap();
        fs::write(project.join("CMakeLists.txt"), &lists).unwrap();
        let cmake = |arguments: &[&str]| {
            let mut command = Command::new("cmake");
            command
                .args(arguments)
                .env("CMAKE_PREFIX_PATH", &prefix)
                .current_dir(&project);
            assert!(command.status().unwrap().success(), "{name}: {arguments:?}");
        };
        cmake(&["-B", "build"]);
        cmake(&["--build", "build"]);
        draws(&project.join("build/still"), &format!("{name}.png"));
    }
    // A release with another interface version is rejected.
    let project = empty.path().join("newer");
    fs::create_dir(&project).unwrap();
    let newer = lists.replace("terrella 0.1 ", "terrella 0.2 ");
    assert_ne!(newer, lists);
    fs::write(project.join("CMakeLists.txt"), newer).unwrap();
    let mut command = Command::new("cmake");
    command
        .args(["-B", "build"])
        .env("CMAKE_PREFIX_PATH", &prefix);
    let output = command.current_dir(&project).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && said.contains("0.1"), "{said}");
}

/// The first code block of a page in a language.
fn fenced<'p>(page: &'p str, language: &str) -> &'p str {
    let (_, block) = page.split_once(&format!("```{language}\n")).unwrap();
    block.split_once("```").unwrap().0
}

/// Installs the wheel with pip into an empty folder, and runs the page's first program with it. `TERRELLA_WHEEL` names an existing wheel.
#[test]
#[ignore = "builds a release; run by `.ci/run --always`, or by hand"]
fn the_wheel_draws_a_first_picture() {
    let python = std::env::var_os("TERRELLA_PYTHON").unwrap_or_else(|| "python3".into());
    let where_numpy_is =
        "import numpy, os; print(os.path.dirname(os.path.dirname(numpy.__file__)))";
    let numpy = Command::new(&python).args(["-c", where_numpy_is]).output();
    let Some(numpy) = numpy.ok().filter(|output| output.status.success()) else {
        eprintln!("SKIPPED: there is no Python with numpy; set TERRELLA_PYTHON to one");
        return;
    };
    let numpy = String::from_utf8(numpy.stdout).unwrap();
    let built = tempfile::tempdir().unwrap();
    let wheel = match std::env::var_os("TERRELLA_WHEEL") {
        Some(wheel) => PathBuf::from(wheel),
        None => {
            run(&[Part::Wheel], None, built.path()).unwrap();
            let is_wheel = |name: &String| name.ends_with(".whl");
            let name = names(built.path()).into_iter().find(is_wheel).unwrap();
            built.path().join(name)
        }
    };
    let empty = tempfile::tempdir().unwrap();
    let site = empty.path().join("site");
    let mut pip = Command::new(&python);
    pip.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--no-index",
        "--target",
    ]);
    assert!(pip.arg(&site).arg(&wheel).status().unwrap().success());
    let maps = names(&site.join("terrella/textures"));
    for map in [
        "SOURCES.md",
        "clouds.jpg",
        "day.jpg",
        "elevation.png",
        "elevation.toml",
        "lines.bin",
        "milky_way.jpg",
        "moon.jpg",
        "night_lights.png",
        "place_names.bin",
        "places.bin",
        "seasons.png",
        "stars.bin",
        "water.png",
    ] {
        assert!(maps.iter().any(|name| name == map), "no {map}: {maps:?}");
    }
    let page = fs::read_to_string(repository_root().join("docs/embedding/python.md")).unwrap();
    let mut program = Command::new(&python);
    program
        .args(["-c", fenced(&page, "python")])
        .current_dir(empty.path())
        .env_remove("TERRELLA_TEXTURES")
        .env_remove("PYTHONHOME");
    let search = std::env::join_paths([site.as_path(), Path::new(numpy.trim())]).unwrap();
    let output = program.env("PYTHONPATH", search).output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{said}");
    let printed = String::from_utf8_lossy(&output.stdout);
    assert!(printed.starts_with("brightest"), "{printed}");
    let picture = image::open(empty.path().join("earth.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (640, 360));
}
