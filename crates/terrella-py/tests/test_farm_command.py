"""The command `python -m terrella.farm`, and errors that workers cannot hide."""

import json
import subprocess
import sys

import pytest
from farm_help import FRAMES, contents, frames_of, write_scene
from terrella import farm


def run(folder, *arguments):
    return subprocess.run([sys.executable, "-m", "terrella.farm", *map(str, arguments)], cwd=folder, capture_output=True, text=True)


def test_a_film_a_sweep_and_a_pack(tmp_path, root):
    write_scene(tmp_path)
    ran = run(tmp_path, "film", "scene.toml", "-o", "film", "--frames", "2..=4", "--size", "64x40", "--workers", "2")
    assert ran.returncode == 0, ran.stderr
    assert "3 of 3 frames: 3 drawn" in ran.stdout
    assert [frame["index"] for frame in frames_of(tmp_path / "film")] == [2, 3, 4]
    (tmp_path / "flown.py").write_text("def pitch_deg(random):\n    return -80.0\n")
    ran = run(tmp_path, "sweep", "scene.toml", "-o", "swept", "--count", "5", "--size", "32x20", "--layers", "lit,land", "--workers", "1",
              "--height-m", "loguniform:5e5:9e5", "--pitch-deg", "flown.pitch_deg", "--heading-deg", "choice:0:90", "--region=-10,35,20,60",
              "--time", "2018-06-21T08:00:00Z..2018-06-21T16:00:00Z", "--fov-deg", "normal:40:5:20:60", "--samples-a-shard", "2", "--quiet")
    assert ran.returncode == 0 and ran.stdout == "", ran.stderr
    drawn = json.loads((tmp_path / "swept/manifest.json").read_text())["drawn"]
    assert drawn["place"] == "OnSphere(lat_deg=(35.0, 60.0), lon_deg=(-10.0, 20.0))"
    assert drawn["pitch_deg"].startswith("flown.pitch_deg (") and drawn["heading_deg"] == "Choice(values=(0.0, 90.0), weights=None)"
    assert len(contents(tmp_path / "swept", ".tar")) == 3
    ran = run(tmp_path, "pack", "-o", "earth", "--day", root / "textures/day.jpg", "--storage", "plain", "--pixels", "day=64", "--workers", "2")
    assert ran.returncode == 0 and (tmp_path / "earth/pack.toml").is_file(), ran.stderr


@pytest.mark.parametrize("arguments, code, words", [
    ([], 2, "required"),
    (["film", "nowhere.toml", "-o", "out"], 2, "nowhere.toml"),
    (["film", "scene.toml", "-o", "out", "--size", "64"], 2, "1280x720"),
    (["film", "scene.toml", "-o", "out", "--frames", "4..4"], 2, "frames"),
    (["film", "scene.toml", "-o", "out", "--workers", "0"], 2, "workers"),
    (["film", "scene.toml", "-o", "out", "--adapter", "voodoo"], 1, "voodoo"),
    (["sweep", "scene.toml", "-o", "out", "--count", "1", "--height-m", "uniform:1"], 2, "uniform takes 2 numbers"),
    (["sweep", "scene.toml", "-o", "out", "--count", "1", "--height-m", "nowhere.function"], 2, "nowhere.function"),
    (["sweep", "scene.toml", "-o", "out", "--count", "1", "--fov-deg", "400"], 2, "fov_deg: 400"),
    (["pack", "-o", "out", "--day", "nowhere.jpg"], 1, "nowhere.jpg"),
])
def test_what_is_wrong_is_said(tmp_path, arguments, code, words):
    write_scene(tmp_path)
    ran = run(tmp_path, *arguments)
    assert (ran.returncode, "Traceback" in ran.stderr) == (code, False) and words in ran.stderr, ran


def test_a_worker_that_always_dies_is_given_up(tmp_path, monkeypatch):
    """As of a driver that brings its process down: three attempts, and the others' frames are done."""
    (tmp_path / "deadly.py").write_text(
        "import os\nfrom terrella.farm import _film\nreal = _film.draw_part\n\n\n"
        "def draw_part(part):\n    if part['frames'][0][0] == 5:\n        os.abort()\n    return real(part)\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    import deadly
    from terrella.farm import _film

    monkeypatch.setattr(_film, "draw_part", deadly.draw_part)
    with pytest.raises(farm.FarmError, match="frame 5, tried 3 times: its worker died .signal 6.") as raised:
        farm.film(write_scene(tmp_path), tmp_path / "out", workers=2, frames_a_task=1, retries=2)
    report = raised.value.report
    assert (report.done, report.lost_workers, len(report.failed)) == (FRAMES - 1, 3, 1)
    assert len(contents(tmp_path / "out", ".png")) == FRAMES - 1


def test_workers_that_never_start_end_the_run(tmp_path, monkeypatch):
    scene = write_scene(tmp_path)
    monkeypatch.setattr(sys, "executable", "/bin/false")
    with pytest.raises(farm.FarmError, match="32 attempts in a row went wrong, the last because its worker died .exit code 1.; 0 of 24 frames"):
        farm.film(scene, tmp_path / "out", workers=2, frames_a_task=1)


def test_a_lost_device_is_tried_again_with_a_new_one(tmp_path, monkeypatch):
    (tmp_path / "shaky.py").write_text(
        "import pathlib\nfrom terrella import _native\nfrom terrella.farm import _film\nreal = _film.draw_part\n\n\n"
        "def draw_part(part):\n    reported = pathlib.Path(part['out']).parent / 'reported'\n"
        "    if part['frames'][0][0] == 3 and not reported.exists():\n        reported.touch()\n        raise _native.DeviceError('lost')\n"
        "    return real(part)\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    import shaky
    from terrella.farm import _film

    monkeypatch.setattr(_film, "draw_part", shaky.draw_part)
    report = farm.film(write_scene(tmp_path), tmp_path / "out", workers=1, frames_a_task=1, frames=range(0, 6))
    assert (tmp_path / "reported").exists() and (report.done, report.failed, report.lost_workers) == (6, [], 0)


def test_one_run_at_a_time_writes_to_a_folder(tmp_path):
    from terrella.farm import _files

    scene = write_scene(tmp_path)
    lock = _files.Lock(tmp_path / "out")
    with pytest.raises(farm.FarmError, match="another run"):
        farm.sweep(scene, tmp_path / "out", 1, size=(16, 16), layers=[])
    lock.release()
    assert farm.sweep(scene, tmp_path / "out", 1, size=(16, 16), layers=[], workers=1).done == 1


def test_no_file_is_half_there(tmp_path):
    from terrella.farm import _files

    with pytest.raises(ZeroDivisionError):
        with _files.pending(tmp_path / "a.bin") as (file, _):
            file.write(b"half")
            raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []
    _files.write_whole(tmp_path / "a.bin", b"whole", durable=True)
    assert (tmp_path / "a.bin").read_bytes() == b"whole" and len(list(tmp_path.iterdir())) == 1
    (tmp_path / "b").write_bytes(b"")
    assert (tmp_path / "a.bin").stat().st_mode == (tmp_path / "b").stat().st_mode


def test_a_journal_that_was_cut_off_counts_as_far_as_it_goes(tmp_path):
    from terrella.farm import _files

    journal = _files.Journal(tmp_path)
    journal.note({"file": "a"})
    journal.note({"file": "b"})
    journal.close()
    journal.path.write_bytes(journal.path.read_bytes()[:-5])
    assert list(_files.journals(tmp_path)) == [{"file": "a"}]


def test_scenes_without_instants_of_their_own_are_rejected(tmp_path, root):
    scene = write_scene(tmp_path, (root / "config/live.toml").read_text(), "live.toml")
    with pytest.raises(Exception, match="play it with the command"):
        farm.film(scene, tmp_path / "out")
    assert not (tmp_path / "out").exists()
