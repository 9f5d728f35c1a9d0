"""Hands work out, tries again, and tells how far it is."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from typing import Any

from ._engine import Answer, Call, Engine
from ._report import FarmError, Failure, Report

Progress = Callable[[int, int], None]
# A run ends after this many failed attempts in a row: more would not help.
MOST_MISSES = 32


class Bar:
    """How far it is, on standard error."""

    def __init__(self, what: str):
        self._what = what
        self._begin = self._shown = time.monotonic()
        self._first: int | None = None

    def __call__(self, done: int, wanted: int) -> None:
        now = time.monotonic()
        if self._first is None:
            self._first = done
        if done < wanted and now - self._shown < 0.2:
            return
        self._shown = now
        drawn, seconds = done - self._first, now - self._begin
        rate = drawn / seconds if seconds > 0 else 0.0
        left = f", {(wanted - done) / rate:.0f} s left" if rate > 0 and done < wanted else ""
        cells = 30 * done // wanted if wanted else 30
        end = "\n" if done >= wanted else ""
        sys.stderr.write(f"\r[{'#' * cells}{'.' * (30 - cells)}] {done} of {wanted} {self._what}, {rate:.1f} a second{left}   {end}")
        sys.stderr.flush()


def shown(progress: bool | Progress | None, what: str) -> Progress:
    """A bar where it can be seen, the caller's own, or nothing."""
    if callable(progress):
        return progress
    if progress or (progress is None and sys.stderr.isatty()):
        return Bar(what)
    return lambda done, wanted: None


def drive(engine: Engine, calls: Iterator[Call], report: Report, *, retries: int, progress: Progress,
          take: Callable[[Call, Any], None]) -> None:
    """Has all calls answered. `take` gets what they give, in the order in which it comes.

    A worker that is lost, and an error that may not come again, are followed by another attempt, `retries` times at most.
    """
    begin, moved, lost = time.monotonic(), engine.bytes_moved, engine.lost_workers
    open_calls = misses = 0
    progress(report.kept + report.done, report.wanted)
    try:
        more = True
        while True:
            while more and engine.room() > 0:
                call = next(calls, None)
                if call is None:
                    more = False
                else:
                    engine.submit(call)
                    open_calls += 1
            if open_calls == 0:
                return
            answer = engine.next()
            open_calls -= 1
            if answer.full:
                raise FarmError(f"{answer.error} and run the same again: {_so_far(report)}", report)
            again, reason = _again(answer, retries), answer.lost or answer.error
            misses = 0 if reason is None else misses + 1
            if again:
                engine.submit(answer.call)
                open_calls += 1
            elif reason is not None:
                report.failed.append(Failure(answer.call.name, reason, answer.call.attempts))
            if misses >= MOST_MISSES:
                raise FarmError(f"{report.out}: {misses} attempts in a row went wrong, the last because {reason}; {_so_far(report)}", report)
            if reason is not None:
                continue
            take(answer.call, answer.value)
            progress(report.kept + report.done, report.wanted)
    except FarmError as error:
        raise FarmError(str(error) if error.report else f"{error}; {_so_far(report)}", report) from error.__cause__
    finally:
        report.seconds += time.monotonic() - begin
        report.bytes_moved += engine.bytes_moved - moved
        report.lost_workers += engine.lost_workers - lost


def _again(answer: Answer, retries: int) -> bool:
    answer.call.attempts += 1
    return (answer.lost is not None or answer.again) and answer.call.attempts <= retries


def _so_far(report: Report) -> str:
    return f"{report.kept + report.done} of {report.wanted} {report.what} are done and kept"


def reject_failures(report: Report) -> None:
    """Raises where something was given up."""
    if report.failed:
        first = report.failed[0]
        others = f" (and {len(report.failed) - 1} more)" if len(report.failed) > 1 else ""
        raise FarmError(f"{report.out}: {_so_far(report)}; the same run again tries the rest. {first}{others}", report)


def checked_retries(retries: int) -> int:
    if not 0 <= retries <= 100:
        raise ValueError(f"retries: {retries} is not from 0 to 100")
    return retries
