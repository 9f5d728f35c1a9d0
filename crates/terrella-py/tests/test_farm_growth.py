"""The numbers on the page are what is made of the runs that were measured."""

import subprocess
import sys


def test_the_tables_are_those_of_the_runs(root):
    ran = subprocess.run([sys.executable, root / "crates/terrella-py/benches/farm_growth.py", "--check"], capture_output=True, text=True)
    assert ran.returncode == 0, ran.stderr
