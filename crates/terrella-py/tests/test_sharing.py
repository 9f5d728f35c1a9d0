"""Earths of one program share their device and their maps."""

import os
import subprocess
import sys

import pytest

PRELUDE = """
import os, sys, threading
import terrella

NOON = "2018-06-21T12:00:00Z"
CAMERA = terrella.Camera.geodetic(10, 0, 1.2e7)

def drawn(**options):
    earth = terrella.Earth(size=(64, 36), **options)
    return earth, earth.color(CAMERA, NOON)

def resident_mb():
    with open("/proc/self/statm") as pages:
        return int(pages.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
"""


def run(program: str) -> str:
    done = subprocess.run([sys.executable, "-c", PRELUDE + program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.skipif(not os.path.exists("/proc/self/statm"), reason="memory is read as on Linux")
def test_a_further_earth_has_no_maps_of_its_own():
    """The starter maps take over 100 MB. Bounds are wide."""
    first, further = map(
        float,
        run("""
before = resident_mb()
kept = [drawn()]
first = resident_mb()
kept += [drawn() for _ in range(4)]
assert all((picture == kept[0][1]).all() for _, picture in kept)
print(first - before, (resident_mb() - first) / 4)
""").split(),
    )
    assert first > 80
    assert further < 0.4 * first, (first, further)


def test_other_maps_are_not_shared():
    run("""
(_, with_clouds), (_, without) = drawn(), drawn(clouds=False)
assert (with_clouds != without).any()
assert (drawn()[1] == with_clouds).all()
""")


def test_threads_make_earths_together():
    run("""
pictures = []
threads = [threading.Thread(target=lambda: pictures.append(drawn()[1])) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
assert len(pictures) == 4 and all((picture == pictures[0]).all() for picture in pictures)
""")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_child_opens_its_own_device():
    run("""
kept, picture = drawn()
child = os.fork()
if child == 0:
    _, own = drawn()
    os._exit(0 if (own == picture).all() else 7)
_, status = os.waitpid(child, 0)
assert os.waitstatus_to_exitcode(status) == 0, status
assert (drawn()[1] == picture).all()
""")
