"""Films of many workers: the same files as the command's, through any end."""

import json
import os
import resource
import shutil
import subprocess

import pytest
import terrella
from farm_help import FRAMES, SCENE, begin, children, contents, frames_of, inodes, is_alive, kill, wait_for, write_scene
from terrella import farm

RUN = """
import sys
from terrella import farm
print(farm.film(sys.argv[1], sys.argv[2], workers=2, frames_a_task=2))
"""


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    """A scene, and its film as one worker draws it."""
    folder = tmp_path_factory.mktemp("film")
    scene = write_scene(folder)
    report = farm.film(scene, folder / "one", workers=1)
    assert (report.done, report.kept, report.failed, report.wanted) == (FRAMES, 0, [], FRAMES)
    return folder


def test_two_workers_draw_what_one_draws(film, tmp_path):
    reported = []
    report = farm.film(film / "scene.toml", tmp_path / "two", workers=2, frames_a_task=1, progress=lambda *state: reported.append(state))
    assert report.done == FRAMES and len(report.by_worker) == 2, report
    assert min(report.by_worker.values()) >= 1 and sum(report.by_worker.values()) == FRAMES
    assert contents(tmp_path / "two", ".png") == contents(film / "one", ".png")
    assert (tmp_path / "two/frames.json").read_text() == (film / "one/frames.json").read_text()
    assert reported[0] == (0, FRAMES) and reported[-1] == (FRAMES, FRAMES) and reported == sorted(reported)
    # The frames differ and their exposure follows the light; otherwise this test would prove little.
    assert len(set(contents(film / "one", ".png").values())) == FRAMES
    exposures = [frame["exposure_ev"] for frame in frames_of(film / "one")]
    assert max(exposures) - min(exposures) > 1, exposures
    assert sorted(os.listdir(tmp_path / "two")) == sorted([*contents(film / "one", ".png"), "frames.json"])


@pytest.mark.skipif("TERRELLA_COMMAND" not in os.environ, reason="the command terrella was not built beside the tests")
def test_films_are_those_of_the_command(film, tmp_path):
    scene, command = film / "scene.toml", os.environ["TERRELLA_COMMAND"]
    environment = {**os.environ, "TERRELLA_TEXTURES": os.environ["TERRELLA_TEXTURES"]}
    play = [command, "-q", "play", scene, "--frames"]
    subprocess.run([*play, tmp_path / "whole"], check=True, env=environment)
    assert contents(tmp_path / "whole", ".png") == contents(film / "one", ".png")
    pages = [json.loads((folder / "frames.json").read_text()) for folder in (tmp_path / "whole", film / "one")]
    assert pages[0] == pages[1]
    # Each resumes the other's film.
    subprocess.run([*play, tmp_path / "half", "--range", "0..9"], check=True, env=environment)
    before = inodes(tmp_path / "half", ".png")
    report = farm.film(scene, tmp_path / "half", workers=2)
    assert (report.kept, report.done) == (9, FRAMES - 9)
    after = inodes(tmp_path / "half", ".png")
    assert {name: after[name] for name in before} == before
    assert contents(tmp_path / "half", ".png") == contents(film / "one", ".png")
    farm.film(scene, tmp_path / "farm", frames=range(4, 13), workers=2)
    before = inodes(tmp_path / "farm", ".png")
    assert sorted(before) == [f"frame_{n:05}.png" for n in range(4, 13)]
    subprocess.run([*play, tmp_path / "farm", "--resume"], check=True, env=environment)
    after = inodes(tmp_path / "farm", ".png")
    assert {name: after[name] for name in before} == before
    assert contents(tmp_path / "farm", ".png") == contents(film / "one", ".png")


def test_pictures_of_light_are_the_same_on_two_workers(film, tmp_path):
    for options, ending in [({"format": "png16", "shutter": 0.5, "subframes": 2}, ".png"), ({"format": "exr", "supersample": 2}, ".exr")]:
        folders = [tmp_path / f"{ending}{workers}" for workers in (1, 2)]
        for workers, folder in enumerate(folders, 1):
            farm.film(film / "scene.toml", folder, frames=range(3, 7), workers=workers, **options)
        one, two = (contents(folder, ending) for folder in folders)
        assert one == two and len(set(one.values())) == 4
        assert ("shutter_ns" in frames_of(folders[0])[0]) == ("shutter" in options)


def test_a_worker_that_is_killed_takes_nothing_along(film, tmp_path):
    out = tmp_path / "out"
    run = begin(RUN, film / "scene.toml", out)
    wait_for(lambda: out.is_dir() and len(contents(out, ".png")) >= 4, "four frames")
    before = inodes(out, ".png")
    kill(children(run.pid)[0])
    words, errors = run.communicate(timeout=120)
    assert run.returncode == 0, errors
    assert "1 workers died" in words and f"{FRAMES} of {FRAMES} frames" in words, words
    after = inodes(out, ".png")
    assert {name: after[name] for name in before} == before
    assert contents(out, ".png") == contents(film / "one", ".png")
    assert [name for name in os.listdir(out) if name.startswith(".")] == []


def test_who_began_the_run_may_be_killed(film, tmp_path):
    out = tmp_path / "out"
    run = begin(RUN, film / "scene.toml", out)
    wait_for(lambda: out.is_dir() and len(contents(out, ".png")) >= 6, "six frames")
    workers = children(run.pid)
    assert len(workers) == 2
    kill(run.pid)
    run.communicate()
    # Workers exit with their parent.
    wait_for(lambda: not any(map(is_alive, workers)), "the workers' end", 20)
    before = inodes(out, ".png")
    assert 6 <= len(before) < FRAMES
    report = farm.film(film / "scene.toml", out, workers=2)
    # All finished frames are kept, including those that the page does not list yet.
    assert (report.kept, report.done) == (len(before), FRAMES - len(before))
    after = inodes(out, ".png")
    assert {name: after[name] for name in before} == before
    assert contents(out, ".png") == contents(film / "one", ".png")
    assert frames_of(out) == frames_of(film / "one")
    again = farm.film(film / "scene.toml", out)
    assert (again.kept, again.done) == (FRAMES, 0)
    assert inodes(out, ".png") == after


def test_a_frame_that_was_corrupt_is_drawn_again(film, tmp_path):
    shutil.copytree(film / "one", tmp_path / "out")
    corrupt = tmp_path / "out/frame_00005.png"
    corrupt.write_bytes(corrupt.read_bytes()[:-1] + b"x")
    (tmp_path / "out/frame_00007.png").unlink()
    report = farm.film(film / "scene.toml", tmp_path / "out", workers=1)
    assert (report.kept, report.done) == (FRAMES - 2, 2)
    assert contents(tmp_path / "out", ".png") == contents(film / "one", ".png")


def test_other_films_are_rejected(film, tmp_path):
    shutil.copytree(film / "one", tmp_path / "out")
    other = write_scene(tmp_path, SCENE.replace("lon_deg = 130", "lon_deg = 131"))
    for scene, options, words in [
        (other, {}, "the scene has changed"),
        (film / "scene.toml", {"size": (80, 50)}, "96 × 64 pixels, these 80 × 50"),
        (film / "scene.toml", {"supersample": 2}, "--supersample"),
    ]:
        with pytest.raises(terrella.Error, match=words):
            farm.film(scene, tmp_path / "out", workers=1, **options)
    assert contents(tmp_path / "out", ".png") == contents(film / "one", ".png")
    report = farm.film(other, tmp_path / "out", workers=1, overwrite=True)
    assert (report.kept, report.done) == (0, FRAMES)
    (tmp_path / "busy").mkdir()
    (tmp_path / "busy/notes.txt").write_text("mine")
    with pytest.raises(terrella.Error, match="no frames.json"):
        farm.film(film / "scene.toml", tmp_path / "busy")
    for options, words in [
        ({"workers": 0}, "workers"),
        ({"frames": range(0, 10, 2)}, "frames"),
        ({"frames": range(20, 30)}, "are 0 to 23"),
        ({"format": "gif"}, "format"),
        ({"shutter": 2.0}, "shutter"),
        ({"format": "exr", "video": "a.mp4"}, "video"),
        ({"workers": 2, "address": "tcp://127.0.0.1:1"}, "workers"),
        ({"retries": -1}, "retries"),
    ]:
        with pytest.raises((ValueError, terrella.Error), match=words):
            farm.film(film / "scene.toml", tmp_path / "new", **options)


def test_a_disk_that_fills_keeps_what_was_done(film, tmp_path):
    out = tmp_path / "out"
    sizes = sorted(len(one) for one in contents(film / "one", ".png").values())
    limit = (sizes[0] + sizes[-1]) // 2
    assert sizes[0] < limit < sizes[-1]

    def limited():
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    run = begin(RUN, film / "scene.toml", out, preexec_fn=limited)
    _, errors = run.communicate(timeout=120)
    assert run.returncode == 1
    assert "FarmError" in errors and "make room and run the same again" in errors, errors
    there = contents(out, ".png")
    whole = contents(film / "one", ".png")
    assert all(whole[name] == bytes_ for name, bytes_ in there.items())
    before = inodes(out, ".png")
    report = farm.film(film / "scene.toml", out, workers=2)
    assert report.kept == len(before)
    after = inodes(out, ".png")
    assert {name: after[name] for name in before} == before
    assert contents(out, ".png") == whole
    assert [name for name in os.listdir(out) if name.startswith(".")] == []


def test_frames_of_a_pack_depend_on_no_others(root, tmp_path):
    """Tiles have levels with hysteresis where they are shown; pictures that are kept have none."""
    maps = root / "textures"
    farm.pack(tmp_path / "earth", maps / "day.jpg", storage="plain", pixels={"day": [256, 128, 64, 32]}, workers=1)
    scene = write_scene(tmp_path, """
[time]
start = "2018-01-15T12:00:00Z"
speed = 60
frame_rate_hz = 1
duration_s = 2400
[camera]
mode = "geodetic"
keys = [{ time_s = 0, lat_deg = 10, lon_deg = 10, height_km = 800 }, { time_s = 1200, lat_deg = 20, lon_deg = 40, height_km = 6000 },
    { time_s = 2400, lat_deg = 10, lon_deg = 60, height_km = 800 }]
[earth]
pack = "earth"
[output]
samples = 1
""".replace(",\n    {", ", {"))
    for workers, each in [(1, 40), (2, 1)]:
        report = farm.film(scene, tmp_path / f"of{workers}", size=(320, 200), workers=workers, frames_a_task=each)
        assert report.done == 40 and report.notes == []
    assert contents(tmp_path / "of1", ".png") == contents(tmp_path / "of2", ".png")


def test_ground_that_remembers_is_reported(root, tmp_path):
    for surface, is_reported in [("quadtree", True), ("contours", False)]:
        scene = write_scene(tmp_path, f"""
[time]
start = "2018-07-15T14:00:00Z"
duration_s = 1
frame_rate_hz = 1
[camera]
mode = "geodetic"
height_km = 60
[earth]
elevation = ["{root / 'textures/elevation.png'}"]
surface = "{surface}"
""", f"{surface}.toml")
        report = farm.film(scene, tmp_path / surface, size=(32, 20), workers=1)
        assert report.done == 1 and any("frames before" in note for note in report.notes) == is_reported


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_the_video_is_that_of_the_frames(film, tmp_path):
    video = tmp_path / "film.mp4"
    report = farm.film(film / "scene.toml", film / "one", video=video, crf=0)
    assert report.video == video and [one.name for one in tmp_path.iterdir()] == ["film.mp4"]

    def sums(*arguments):
        reported = subprocess.run(["ffmpeg", "-v", "error", *arguments, "-f", "framemd5", "-"], capture_output=True, text=True, check=True).stdout
        return [line.split(",")[-1] for line in reported.splitlines() if not line.startswith("#")]

    # With crf 0 only the conversion to 4:2:0 is lossy; repeat it here.
    picked = ["-framerate", "10", "-i", str(film / "one/frame_%05d.png"), "-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p"]
    assert sums("-i", str(video)) == sums(*picked) and len(sums(*picked)) == FRAMES

    # Files like those that ffmpeg leaves on a full disk, with status 0.
    from terrella._native import mp4_problem

    contents, cut = video.read_bytes(), tmp_path / "cut.mp4"
    assert mp4_problem(video, FRAMES) is None and "frames" in mp4_problem(video, FRAMES + 1)
    for length in (0, 4, 100, len(contents) // 2, len(contents) - 1):
        cut.write_bytes(contents[:length])
        assert mp4_problem(cut, FRAMES), length


def test_workers_reject_other_scenes_than_were_meant(film, tmp_path, monkeypatch):
    from terrella.farm import _worker

    real = _worker.expected_inputs
    for what, value in [("scene", "0" * 64), ("maps", "0" * 64), ("version of terrella", "0.0.0")]:
        monkeypatch.setattr(_worker, "expected_inputs", lambda *paths: {**real(*paths), what: value})
        with pytest.raises(farm.FarmError, match=f"{what} is another") as raised:
            farm.film(film / "scene.toml", tmp_path / what, workers=1, frames=range(0, 2), frames_a_task=2)
        report = raised.value.report
        assert report.done == 0 and [failure.attempts for failure in report.failed] == [1]
