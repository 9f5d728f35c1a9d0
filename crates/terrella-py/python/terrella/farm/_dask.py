"""Workers of a Dask cluster: one that runs already, by its address, or one of this machine that nobody else hears."""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import re
import subprocess
import sys
import tempfile
import time
from concurrent.futures import CancelledError
from pathlib import Path
from typing import Any

import distributed

from . import _worker
from ._engine import Answer, Call, Engine
from ._report import FarmError

# Timeout for a silent cluster, seconds.
PATIENCE_S = 15.0


class Dask(Engine):
    """A Dask cluster. Its scheduler tries a task again on another worker when one dies, three times at most."""

    def __init__(self, address: Any, workers: int):
        self._local = self._client = None
        self._owned = not isinstance(address, distributed.Client)
        try:
            if not self._owned:
                self._client = address
            elif address == "local":
                self._local = LocalCluster(workers)
                self._client = self._local.connect()
            else:
                self._client = _connect(address)
            self._open = self._answered = 0
            self._answers: queue.Queue[Any] = queue.Queue()
            self._count()
        except BaseException:
            self.close()
            raise

    @property
    def scheduler_address(self) -> str:
        return self._client.scheduler.address

    def _count(self) -> None:
        try:
            self.workers = max(1, sum(self._client.nthreads().values()))
        except (OSError, TimeoutError):
            raise self._gone() from None

    def room(self) -> int:
        # A few calls wait at each worker so that it never idles; only a few, so that a film of a million frames does not fill the scheduler.
        if self._open == 0:
            self._count()
        return 3 * self.workers - self._open

    def submit(self, call: Call) -> None:
        self._open += 1
        self.bytes_moved += len(pickle.dumps(call.argument))
        try:
            future = self._client.submit(_worker.guarded, call.function, call.argument, pure=False)
        except (OSError, ValueError):
            raise self._gone() from None
        future.add_done_callback(lambda future: self._answers.put((call, future)))

    def next(self) -> Answer:
        begin = time.monotonic()
        while True:
            try:
                call, future = self._answers.get(timeout=0.5)
            except queue.Empty:
                begin = time.monotonic() if self._is_there() else begin
                if time.monotonic() - begin > PATIENCE_S:
                    raise self._gone() from None
                continue
            self._answered += 1
            if self._answered % 256 == 0:
                # Workers may have come or gone.
                self._count()
            self._open -= 1
            try:
                value = future.result() if future.status == "finished" else None
                error = future.exception() if future.status == "error" else None
            except (OSError, TimeoutError, CancelledError):
                raise self._gone() from None
            if value is not None:
                self.bytes_moved += len(pickle.dumps(value))
                return Answer(call, **value)
            if error is not None:
                if isinstance(error, distributed.KilledWorker):
                    self.lost_workers += 1
                    return Answer(call, lost=f"workers died of it ({error.last_worker.address if error.last_worker else 'unknown'})")
                return Answer(call, error=f"the worker cannot do what it is asked to: {error}")
            # Cancelled or lost: the scheduler is gone.
            raise self._gone()

    def _is_there(self) -> bool:
        return self._client.status == "running"

    def _gone(self) -> FarmError:
        return FarmError(f"the Dask scheduler at {self.scheduler_address} does not answer any more; start it again, and run the same again")

    def close(self) -> None:
        if self._owned and self._client is not None:
            with contextlib.suppress(Exception):
                self._client.close(timeout=5)
        if self._local is not None:
            self._local.close()


def _connect(address: str) -> Any:
    if not re.fullmatch(r"(tcp|tls|ws|wss|ucx)://.+:\d+", str(address)):
        raise FarmError(f"address: there is no Dask scheduler at {address!r}; write it as tcp://HOST:PORT")
    try:
        return distributed.Client(address, timeout="15s", set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise FarmError(f"address: there is no Dask scheduler at {address!r}: {error}") from None


class LocalCluster:
    """A scheduler and workers on this machine: on 127.0.0.1 alone, without dashboards, started as programs of their own."""

    def __init__(self, workers: int):
        self._folder = tempfile.TemporaryDirectory(prefix="terrella-farm-", ignore_cleanup_errors=True)
        self._file = Path(self._folder.name) / "scheduler.json"
        environment = dict(os.environ)
        environment["PYTHONPATH"] = os.pathsep.join(path or os.getcwd() for path in sys.path)
        environment["DASK_DISTRIBUTED__DIAGNOSTICS__NVML"] = "false"
        # Without a dashboard they would still answer HTTP on all interfaces.
        common = ["--host", "127.0.0.1", "--no-dashboard", "--dashboard-address", "127.0.0.1:0", "--scheduler-file", str(self._file)]
        quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": self._folder.name,
                 "env": environment}
        command = [sys.executable, "-m", "distributed.cli.dask_scheduler", "--port", "0", "--no-show", *common]
        self._programs = [subprocess.Popen(command, **quiet)]
        cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
        if 1 < workers <= len(cores):
            environment.setdefault("LP_NUM_THREADS", str(len(cores) // workers))
        command = [sys.executable, "-m", "distributed.cli.dask_worker", "--nthreads", "1", "--death-timeout", "30",
                   "--local-directory", self._folder.name, "--memory-limit", "0", *common]
        # One nanny process each, which restarts its worker when it dies.
        self._programs += [subprocess.Popen(command, **quiet) for _ in range(workers)]
        self._workers = workers

    @property
    def scheduler(self) -> subprocess.Popen[bytes]:
        return self._programs[0]

    def connect(self) -> Any:
        """A client, when all workers are there."""
        deadline = time.monotonic() + 60
        while not self._file.exists():
            if self.scheduler.poll() is not None or time.monotonic() > deadline:
                self.close()
                raise FarmError("address: a Dask scheduler could not be started on this machine; `python -m distributed.cli.dask_scheduler` says why")
            time.sleep(0.05)
        client = distributed.Client(scheduler_file=str(self._file), timeout="15s", set_as_default=False)
        client.wait_for_workers(self._workers, timeout=60)
        return client

    def close(self) -> None:
        for program in reversed(self._programs):
            program.terminate()
        for program in self._programs:
            try:
                program.wait(timeout=10)
            except subprocess.TimeoutExpired:
                program.kill()
                program.wait()
        self._folder.cleanup()
