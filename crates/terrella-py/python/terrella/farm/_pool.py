"""Workers on this machine: processes that are started again, never forked, each with its share of the cores."""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import struct
import subprocess
import sys
import threading
from collections import deque
from typing import Any, BinaryIO

from ._engine import Answer, Call, Engine

_LENGTH = struct.Struct("<Q")
# Limit on the length of a message, bytes: answers hold names and numbers.
MAX_MESSAGE_BYTES = 1 << 28


def send(pipe: BinaryIO, message: bytes) -> None:
    pipe.write(_LENGTH.pack(len(message)))
    pipe.write(message)
    pipe.flush()


def receive(pipe: BinaryIO) -> bytes | None:
    """The next message; `None` at the end."""
    head = pipe.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(head)
    if length > MAX_MESSAGE_BYTES:
        return None
    message = pipe.read(length)
    return message if len(message) == length else None


class _Worker:
    def __init__(self, number: int, cores: list[int], answers: queue.Queue[Any]):
        self.number = number
        self.cores = cores
        self.call: Call | None = None
        environment = dict(os.environ)
        # Workers can import the same modules as this process.
        environment["PYTHONPATH"] = os.pathsep.join(path or os.getcwd() for path in sys.path)
        if cores:
            # The software driver would start a thread for each core of the machine.
            environment.setdefault("LP_NUM_THREADS", str(len(cores)))
        command = [sys.executable, "-c", "from terrella.farm._worker import main; main()", ",".join(map(str, cores))]
        self.process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment)
        threading.Thread(target=self._read, args=(answers,), daemon=True).start()

    def _read(self, answers: queue.Queue[Any]) -> None:
        while (message := receive(self.process.stdout)) is not None:
            answers.put((self, message))
        answers.put((self, None))

    def give(self, call: Call) -> int:
        self.call = call
        message = pickle.dumps((call.function, call.argument))
        try:
            send(self.process.stdin, message)
        except OSError:
            # The worker died; its end is reported separately.
            pass
        return len(message)


class Pool(Engine):
    """Processes of this machine."""

    def __init__(self, workers: int):
        self.workers = workers
        self._answers: queue.Queue[Any] = queue.Queue()
        self._waiting: deque[Call] = deque()
        self._all: list[_Worker] = []
        cores = sorted(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else []
        shared = 1 < workers <= len(cores)
        self._cores = [cores[n::workers] if shared else [] for n in range(workers)]

    def room(self) -> int:
        busy = sum(worker.call is not None for worker in self._all)
        return self.workers - busy - len(self._waiting)

    def submit(self, call: Call) -> None:
        if len(self._all) < self.workers:
            number = len(self._all)
            self._all.append(_Worker(number, self._cores[number], self._answers))
        self._waiting.append(call)
        self._hand_out()

    def _hand_out(self) -> None:
        for worker in self._all:
            if worker.call is None and self._waiting:
                self.bytes_moved += worker.give(self._waiting.popleft())

    def next(self) -> Answer:
        while True:
            worker, message = self._answers.get()
            if worker not in self._all:
                continue
            call, worker.call = worker.call, None
            if message is None:
                status = worker.process.wait()
                self.lost_workers += 1
                self._all[worker.number] = _Worker(worker.number, worker.cores, self._answers)
                self._hand_out()
                if call is None:
                    continue
                return Answer(call, lost=f"its worker died ({_end(status)})")
            self.bytes_moved += len(message)
            self._hand_out()
            return Answer(call, **pickle.loads(message))

    def close(self) -> None:
        workers, self._all = self._all, []
        for worker in workers:
            # A worker exits when its standard input closes. Closing fails if it has already died.
            with contextlib.suppress(OSError):
                worker.process.stdin.close()
        for worker in workers:
            try:
                worker.process.wait(timeout=10)
            except subprocess.TimeoutExpired:
                worker.process.kill()
                worker.process.wait()
            worker.process.stdout.close()


def _end(status: int) -> str:
    return f"signal {-status}" if status < 0 else f"exit code {status}"
