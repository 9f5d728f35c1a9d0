"""What carries work to workers. Two kinds: processes of this machine, and a Dask cluster."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any


@dataclass
class Call:
    """A unit of work: a function that workers can import, and what it is given."""

    name: str
    function: Callable[[Any], Any]
    argument: Any
    count: int = 1
    """How many frames, samples or tiles it makes."""
    attempts: int = 0


@dataclass
class Answer:
    """What became of a call: a value, an error in words, or a worker that was lost with it."""

    call: Call
    value: Any = None
    error: str | None = None
    again: bool = False
    """Whether another attempt may go well."""
    full: bool = False
    """Whether there was no room: nothing will go well before there is."""
    lost: str | None = None


class Engine(ABC):
    """Carries calls to workers and brings answers back, in the order in which they come."""

    workers: int
    bytes_moved: int = 0
    lost_workers: int = 0

    @abstractmethod
    def room(self) -> int:
        """How many calls more can usefully be given now."""

    @abstractmethod
    def submit(self, call: Call) -> None:
        """Gives a call to a worker."""

    @abstractmethod
    def next(self) -> Answer:
        """Waits for an answer. Raises `FarmError` where nobody is left who could give one."""

    @abstractmethod
    def close(self) -> None:
        """Lets the workers go."""
