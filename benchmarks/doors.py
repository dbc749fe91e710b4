"""Random recordings through every door: the reports have to be the same, byte by byte.

    python -m benchmarks.doors 2000 --seed 1

Each recording is written as CSV, JSON lines and Parquet, and held as lists, arrays with masks, an
Arrow table, pairs and, where these are installed, frames of pandas and polars. Prints how many
agree with the first of these, and how many but for the position at which a monitor noticed unknown
input; every other disagreement with its seed, and exits with 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import nullcontext
from dataclasses import replace
from itertools import count, islice
from pathlib import Path
from typing import Any

from tests.tools.differential import cases_of
from tests.tools.doors import Content, content_of, doors, in_pieces, whole

from rvmon.errors import RvmonError
from rvmon.session import Spec
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile

EACH = 5
"""Recordings of a specification."""


def told(spec: Spec, trace: object, arguments: dict[str, Any]) -> str:
    """The report as JSON; or what was refused."""
    try:
        report = spec.evaluate(trace, allow_missing=True, **arguments)
        return replace(report, trace="").to_json()
    except RvmonError as error:
        return type(error).__name__


def contents(seed: int, samples: int) -> Iterator[tuple[str, Spec, Content]]:
    """Random recordings without end, with their seeds; every third has a value in every cell."""
    profile, traces = Profile(), TraceProfile(samples, 4 * samples, advances=False)
    for number in count():
        spec = None
        for part, case in enumerate(cases_of(f"{seed}/{number}", profile, traces, EACH)):
            spec = spec or Spec(case.spec)
            own = f"{seed}/{number}/{part}"
            content = content_of(random.Random(own), case)
            if content.rows:
                yield own, spec, whole(content) if part % 3 == 2 else content


def main(argv: Sequence[str]) -> int:
    """Judge so many recordings, and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("recordings", type=int, nargs="?", default=2_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--samples", type=int, default=12, help="of a recording, at most")
    parser.add_argument("--pieces", type=int, metavar="BYTES", help="read files in such pieces")
    options = parser.parse_args(argv)
    with in_pieces(options.pieces) if options.pieces else nullcontext():
        return judge_all(options)


def judge_all(options: argparse.Namespace) -> int:
    """Judge so many recordings through every door."""
    ways = doors()
    agreeing, refused = Counter[str](), Counter[str]()
    found = contents(options.seed, options.samples)
    with tempfile.TemporaryDirectory() as name:
        for seed, spec, content in islice(found, options.recordings):
            expected = None
            for door, write in ways.items():
                given = write(content, Path(name))
                text = told(spec, *given)
                if expected is None:
                    expected = text
                agreeing[door] += text == expected
                refused[door] += text.isidentifier()
                if text != expected:
                    print(f"seed {seed}, {door}:\n  {text}\n  first door: {expected}")
    print(
        f"{options.recordings} recordings, seed {options.seed}, byte by byte as the first door's:"
    )
    for door in ways:
        print(f"  {door:26} {agreeing[door]:6}, refused {refused[door]}")
    return int(any(agreeing[door] < options.recordings for door in ways))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
