"""What a run did, and why one stops."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from .. import _native


@dataclass(frozen=True)
class Failure:
    """A unit of work (a frame, a shard, a part of a pack) that was given up."""

    name: str
    reason: str
    attempts: int

    def __str__(self) -> str:
        times = "once" if self.attempts == 1 else f"{self.attempts} times"
        return f"{self.name}, tried {times}: {self.reason}"


@dataclass
class Report:
    """What a run did."""

    out: Path
    """The folder that it wrote to."""
    what: str
    """What it counts: frames, samples or tiles."""
    wanted: int = 0
    """How many of them there are to be."""
    done: int = 0
    """How many this run drew."""
    kept: int = 0
    """How many were there from earlier runs."""
    failed: list[Failure] = field(default_factory=list)
    """What was given up."""
    seconds: float = 0.0
    """How long it took, seconds."""
    bytes_written: int = 0
    """Bytes of the files that it wrote."""
    bytes_moved: int = 0
    """Bytes of what was sent to workers and what they answered."""
    by_worker: dict[str, int] = field(default_factory=dict)
    """How many of `done` each worker drew."""
    drawing_seconds: float = 0.0
    """Time that workers spent on them, added up, seconds."""
    processor_seconds: float = 0.0
    """Time that processors of workers spent on them, added up, seconds; without what a worker begins with."""
    lost_workers: int = 0
    """Workers that died and were replaced."""
    adapters: set[str] = field(default_factory=set)
    """What drew, with the driver."""
    notes: list[str] = field(default_factory=list)
    """What is worth knowing."""
    video: Path | None = None
    """The video that was put together from the frames."""

    def __str__(self) -> str:
        rate = self.done / self.seconds if self.seconds > 0 else 0.0
        lines = [f"{self.out}: {self.done + self.kept} of {self.wanted} {self.what}: {self.done} drawn in {self.seconds:.1f} s "
                 f"({rate:.1f} a second, {self.bytes_written / 1e6:.1f} MB), {self.kept} kept"]
        if self.lost_workers:
            lines.append(f"{self.lost_workers} workers died; what they had begun was given to others")
        lines += [str(note) for note in self.notes]
        lines += [f"failed: {failure}" for failure in self.failed]
        return "\n".join(lines)


class FarmError(_native.Error):
    """A run that stopped or failed in part. Complete output is kept, and the same call resumes."""

    def __init__(self, words: str, report: Report | None = None):
        super().__init__(words)
        self.report = report
        """What was done, where the run had begun."""
