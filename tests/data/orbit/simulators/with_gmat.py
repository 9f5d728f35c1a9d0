"""Flies low.script with GMAT, which writes its ephemeris files, and makes a table of its report.

    pip install gmatpy==0.2.1            # CPython 3.12 or later: GMAT R2026a without its window
    python with_gmat.py [FOLDER]

The table is of a spacecraft of its own, flown by 67 s at a time, so that its rows lie between the states of the files.
"""

import sys
import tempfile
from datetime import datetime
from pathlib import Path

import gmatpy

OUT = Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
script = Path(__file__).with_name("low.script").read_text()
with tempfile.TemporaryDirectory() as folder:
    filled = Path(folder) / "low.script"
    filled.write_text(script.replace("@OUT@", str(OUT)))
    gmatpy.run_script(filled, outputs={"Sat": ["X"]})

report = OUT / "gmat.report"
frames = ["eme2000", "gcrf", "itrf"]
rows = [",".join(["epoch_utc", *(f"{f}_{a}_m" for f in frames for a in "xyz"), "lat_deg", "lon_deg", "height_m"])]
for line in report.read_text().splitlines()[1:]:
    words = line.split()
    date = datetime.strptime(" ".join(words[:4]), "%d %b %Y %H:%M:%S.%f")
    # The report has every step of the integrator, its time rounded to a millisecond (4 m of flight): only the ends of the
    # 67 s fall on whole ones. While another spacecraft is flown this one stands at its start.
    after_s = (date - datetime(2016, 12, 24, 23)).total_seconds()
    if after_s == 0 or after_s % 67 != 0:
        continue
    numbers = [float(word) for word in words[4:]]
    text = [f"{km * 1e3:.5f}" for km in numbers[:9]] + [f"{v:.10f}" for v in numbers[9:11]] + [f"{numbers[11] * 1e3:.5f}"]
    rows.append(",".join([date.strftime("%Y-%m-%dT%H:%M:%S.%f")[:-3] + "Z", *text]))
(OUT / "gmat.places.csv").write_text("\n".join(rows) + "\n")
report.unlink()
