"""Trials and episodes on many machines, by Ray (https://www.ray.io): the results do not depend on how they are split.

Without a cluster Ray uses this machine's cores. With one, started by ``ray start``, all machines have this package of the same version.

>>> from himc import trials
>>> table = trials.evaluate(100, parts=20)       # as `himc evaluate --trials 100` prints it
>>> rewards = trials.map(play, numbers)          # play(number) makes an environment and returns its reward
"""
from __future__ import annotations

import subprocess
import tempfile
from pathlib import Path
from typing import Callable, Iterable

import ray

from . import Error

__all__ = ["evaluate", "map"]


def map(function: Callable, items: Iterable) -> list:  # as multiprocessing.Pool.map
    """``function`` of each item, in the items' order, on whichever machines are free."""
    remote = ray.remote(function)
    try:
        return ray.get([remote.remote(item) for item in items])
    except ray.exceptions.RayTaskError as failed:  # which has the worker's traceback around it
        raise failed.cause from None


def evaluate(trials: int = 100, parts: int = 1, only: str = "") -> str:
    """The table of `himc evaluate`, CSV; its trials in so many pieces. ``only``: words that keep some of the rows."""
    if not 1 <= parts <= trials:
        raise Error(f"parts: {parts}, expected 1 .. {trials}, the number of trials")
    words = ["--trials", str(trials), *(["--only", only] if only else [])]
    edges = [part * trials // parts for part in range(parts + 1)]
    logs = map(_log, [[*words, "--jobs", "1", "--range", f"{a + 1}-{b}"] for a, b in zip(edges, edges[1:])])
    return _run(words, "".join(logs))[0]


def _log(words: list[str]) -> str:
    return _run(words, "")[1]


def _run(words: list[str], log: str) -> tuple[str, str]:
    """The table, and the log, which begins with that of other runs."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "trials.csv"
        if log:
            path.write_text(log)
        call = [str(Path(__file__).parent / "bin" / "himc"), "evaluate", "--quiet", *words, "--log", str(path)]
        done = subprocess.run(call, capture_output=True, text=True)
        if done.returncode:
            raise Error(done.stderr.strip())
        return done.stdout, path.read_text()
