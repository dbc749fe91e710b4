"""The same recordings in every format, and damaged input of every kind."""

from __future__ import annotations

import os
import random
import tempfile
import traceback
from collections.abc import Iterator
from pathlib import Path

from fuzz.damage import damaged
from fuzz.targets import TARGETS, run, seeds
from tests.tools.differential import Campaign, cases_of
from tests.tools.doors import Content, content_of, doors, told, whole

from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

EACH = 5
"""The number of recordings for each specification."""


def judge_doors(found: Campaign, seed: int, numbers: range) -> None:
    """A recording as CSV, JSON lines, Parquet, arrays, frames …: the same report, byte by byte."""
    with tempfile.TemporaryDirectory() as name:
        for number in numbers:
            for place, spec, content in _contents(f"{seed}/{number}"):
                expected = None
                for door, write in doors().items():
                    trace, arguments = write(content, Path(name))
                    text = told(spec, trace, **arguments)
                    expected = text if expected is None else expected
                    found.counts[door] += 1
                    if text != expected or text.isidentifier():
                        both = f"{text}\n  first door: {expected}"
                        found.disagreements.append(f"{place}, {door}:\n  {both}")


def _contents(seed: str) -> Iterator[tuple[str, Spec, Content]]:
    """Random recordings with their seeds; every third has a value in every cell."""
    traces, spec = TraceProfile(12, 48, advances=False), None
    for part, case in enumerate(cases_of(seed, Profile(), traces, EACH)):
        spec = spec or Spec(case.spec)
        content = content_of(random.Random(f"{seed}/{part}"), case)
        if content.rows:
            yield f"{seed}/{part}", spec, whole(content) if part % 3 == 2 else content


def judge_damage(found: Campaign, seed: int, numbers: range) -> None:
    """Damaged specifications, bindings, models, recordings, snapshots are read or refused."""
    os.environ["RVMON_CACHE"] = "off"
    for number in numbers:
        rng = random.Random(f"{seed}/{number}")
        name = rng.choice(sorted(TARGETS))
        data = damaged(rng.choice(seeds(name)), rng, seeds(name))
        try:
            found.counts[f"{name}: {run(name, data)}"] += 1
        except Exception:  # noqa: BLE001 - this is what is looked for
            found.disagreements.append(
                f"number {number}, {name} {data!r}:\n{traceback.format_exc(limit=-3)}"
            )
