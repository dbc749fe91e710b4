"""All that one run of the benchmarks found."""

from __future__ import annotations

from dataclasses import dataclass, field

from benchmarks.agreement import Agreement
from benchmarks.attempts import OpenAttempts
from benchmarks.measure import Result


@dataclass(frozen=True, slots=True)
class Goal:
    """What is to be reached in one mode.

    Attributes:
        mode: what is measured.
        section: whose results count.
        ours: label of our form.
        peer: label of the peer.
        form: of the formulas.
        times: the peer is to need so many times our CPU time, in the median of the workloads,
        least: and at least so many times on each of them.
        names: the results that count; empty: all.
        changing: only results where at most this share of the rows changes.
    """

    mode: str
    section: str
    ours: str
    peer: str
    form: str
    times: float
    least: float
    names: tuple[str, ...] = ()
    changing: float = 1.0


GOALS = (
    Goal("online, one step from Python", "online", "rvmon step", "sentil", "future", 3, 2),
    Goal("online, one step from Python", "online", "rvmon step", "reelay", "past", 8, 5),
    Goal("online, one step from Python", "online", "rvmon step", "mstlo", "future", 5, 2),
    Goal("online, one step from Python", "online", "rvmon step", "rtamt", "past", 300, 300),
    Goal("online, only what changed", "online", "rvmon step, changes", "reelay", "past", 8, 5),
    Goal("values that change at every row", "unsteady", "rvmon step", "sentil", "future", 3, 2),
    Goal("values that change at every row", "unsteady", "rvmon step", "mstlo", "future", 5, 2),
    Goal("formulas that fail at 1 % and 30 %", "failing", "rvmon step", "sentil", "future", 3, 2),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "sentil", "future", 3, 2),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "reelay", "past", 8, 5),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "mstlo", "future", 5, 2),
    Goal("10 to 1,000 monitors", "many", "rvmon step", "sentil", "future", 3, 2),
    Goal("10 to 1,000 monitors", "many", "rvmon step", "reelay", "past", 8, 5),
    Goal("a deadline of 10 to 100,000 rows", "bound", "rvmon step", "sentil", "future", 3, 2),
    Goal("batch in memory", "batch", "rvmon evaluate", "reelay", "past", 30, 30),
    Goal(
        "batch in memory, ≤ 10 % of rows change",
        "batch",
        "rvmon evaluate",
        "reelay C++",
        "past",
        5,
        5,
        changing=0.1,
    ),
    Goal("batch in memory", "batch", "rvmon evaluate", "reelay C++", "past", 1.5, 1.5),
    Goal("whole process, CSV", "process", "rvmon run, csv", "reelay C++, csv", "past", 0.5, 0.5),
    Goal(
        "whole process, Parquet", "process", "rvmon run, parquet", "reelay, parquet", "past", 5, 5
    ),
)

FLATNESS = 1.2
"""The most by which bound 100,000 may cost more than bound 10."""

ATTEMPT_BYTES = 24
"""The most memory of an open attempt."""


@dataclass(frozen=True, slots=True)
class Findings:
    """One run.

    Attributes:
        command: that prints it.
        machine: processor, cores, system, interpreter.
        versions: by name.
        results: all measured workloads.
        open_attempts: by number.
        agreements: by contender and workload.
        differences: lines of the table of readings.
        files: lines of the table of whole files.
        r2u2: lines of the table of `benchmarks.r2u2`.
        absent: what was not measured, and why.
    """

    command: str
    machine: str
    versions: dict[str, str]
    results: tuple[Result, ...] = ()
    open_attempts: tuple[OpenAttempts, ...] = ()
    agreements: tuple[Agreement, ...] = ()
    differences: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    r2u2: tuple[str, ...] = ()
    absent: dict[str, str] = field(default_factory=dict)
