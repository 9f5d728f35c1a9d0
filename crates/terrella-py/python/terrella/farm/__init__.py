"""Many pictures on many workers: films, labelled data sets and imagery packs.

>>> from terrella import farm
>>> print(farm.film("config/iss.toml", "frames", video="iss.mp4", frames=range(30), workers=2))

Workers are processes of this machine, or those of a Dask cluster by its address. Each keeps its renderer warm, writes files itself and answers
with names. A file gets its name only when it is complete; the same call resumes an interrupted run.
"""

from ._dataset import DataSet, coco
from ._film import film
from ._pack import pack
from ._report import FarmError, Failure, Report
from ._sweep import sweep
from .distributions import Choice, Constant, Dates, LogUniform, Normal, OnSphere, Uniform

__all__ = [
    "Choice",
    "Constant",
    "DataSet",
    "Dates",
    "FarmError",
    "Failure",
    "LogUniform",
    "Normal",
    "OnSphere",
    "Report",
    "Uniform",
    "coco",
    "film",
    "pack",
    "sweep",
]
