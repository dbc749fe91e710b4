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
        times: the peer is to need at least so many times our CPU time.
        names: the results that count; empty: all.
        changing: only results where at most this share of the rows changes.
    """

    mode: str
    section: str
    ours: str
    peer: str
    form: str
    times: float
    names: tuple[str, ...] = ()
    changing: float = 1.0


GOALS = (
    Goal("online, one step from Python", "online", "rvmon step", "reelay", "past", 5),
    Goal("online, one step from Python", "online", "rvmon step", "rtamt", "past", 200),
    Goal("online, one step from Python", "online", "rvmon step", "mstlo", "future", 5),
    Goal("online, only what changed", "online", "rvmon step, changes", "reelay", "past", 5),
    Goal("values that change at every row", "unsteady", "rvmon step", "sentil", "future", 4),
    Goal("values that change at every row", "unsteady", "rvmon step", "mstlo", "future", 5),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "reelay", "past", 5),
    Goal("robot, 20 Hz and 1 kHz", "robot", "rvmon step", "mstlo", "future", 5),
    Goal(
        "100 monitors on one stream", "many", "rvmon step", "reelay", "past", 50, ("100 monitors",)
    ),
    Goal(
        "100 monitors, only what changed",
        "many",
        "rvmon step, changes",
        "reelay",
        "past",
        50,
        ("100 monitors",),
    ),
    Goal("10 to 1,000 monitors", "many", "rvmon step", "sentil", "future", 3),
    Goal("batch in memory", "batch", "rvmon evaluate", "reelay", "past", 30),
    Goal("batch in memory", "batch", "rvmon evaluate", "reelay C++", "past", 10),
    Goal("whole process, CSV", "process", "rvmon run, csv", "reelay C++, csv", "past", 0.5),
    Goal("whole process, Parquet", "process", "rvmon run, parquet", "reelay, parquet", "past", 5),
)
"""Mstlo has no factor in the design; it is given reelay's."""


@dataclass(frozen=True, slots=True)
class Quoted:
    """A figure of a peer that cannot be measured here.

    Attributes:
        mode: what was measured.
        section: whose results ours is taken from.
        ours: label of our form.
        peer: who.
        figure: CPU ns per row, from another machine: the least and the most.
        times: the peer is to need at least so many times ours.
        names: the results that count; empty: all.
    """

    mode: str
    section: str
    ours: str
    peer: str
    figure: tuple[float, float]
    times: float
    names: tuple[str, ...] = ()


QUOTED = (
    Quoted("batch in memory", "batch", "rvmon evaluate", "R2U2 C", (37, 195), 10),
    Quoted("whole process, CSV", "process", "rvmon run, csv", "R2U2 C", (107, 179), 0.5),
    Quoted("whole process, JSONL", "process", "rvmon run, jsonl", "reelay", (128, 164), 2),
)
"""Measured on another machine on these families; R2U2 is not on the package index."""

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
