"""Instants for the steps of a template, chosen within its limits."""

from __future__ import annotations

import random
from math import inf
from typing import Any

from rvmon.cdv.files import TestError
from rvmon.cdv.template import Limit, Template


def choose_times(template: Template[Any], rng: random.Random, patience: int) -> list[int]:
    """Instants of all steps in units since the start, the start first.

    They are fixed in turn, each within what those before it leave open.

    Args:
        template: whose limits they keep.
        rng: chooses.
        patience: units of time by which a wait may exceed its least one.

    Raises:
        TestError: the limits contradict each other.
    """
    size = len(template.steps) + 1
    most = [[0.0 if p == q else inf for q in range(size)] for p in range(size)]
    neighbours = [
        Limit(last - 1, last, step.wait) for last, step in enumerate(template.steps, start=1)
    ]
    for limit in (*neighbours, *template.limits):
        first, last, wait = limit.first, limit.last, limit.wait
        most[last][first] = min(most[last][first], -wait.at_least)
        if wait.at_most is not None:
            most[first][last] = min(most[first][last], wait.at_most)
    for middle in range(size):
        for p in range(size):
            for q in range(size):
                most[p][q] = min(most[p][q], most[p][middle] + most[middle][q])
    if any(most[p][p] < 0 for p in range(size)):
        raise TestError(f"template {template.name}: no times satisfy all of its limits")
    times = [0]
    for step in range(1, size):
        low = max(times[p] - most[step][p] for p in range(step))
        high = min(times[p] + most[p][step] for p in range(step))
        times.append(rng.randint(int(low), int(min(high, low + patience))))
    return times
