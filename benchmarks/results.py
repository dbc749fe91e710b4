"""The page of results: what the product costs beside all peers, and what grows how.

    python -m benchmarks.results [--quick] [--only SECTION …] [--r2u2 FOLDER] [--out FILE]

Runs `online`, `recordings`, the cliffs of `growth`, and the table of where peers read otherwise.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from benchmarks.growth import cliffs
from benchmarks.page import TITLES, Findings, render
from benchmarks.peers import differences
from benchmarks.peers.environment import prepare
from benchmarks.timing import files, race
from benchmarks.timing.measure import QUICK, Size

OUT = Path(__file__).with_name("RESULTS.md")
RECORDINGS = ("batch", "process", "files")
SECTIONS = (*race.ONLINE, *RECORDINGS, "cliffs", "differences")


def run(size: Size, sections: Sequence[str], command: str, r2u2: Path | None) -> Findings:
    began = time.monotonic()
    environment = prepare()
    results, agreements = race.run(size, sections, environment, r2u2)
    if "process" in sections:
        more, agreed = files.processes(size, environment)
        results, agreements = [*results, *more], [*agreements, *agreed]
    tables = []
    if "files" in sections:
        race.say("whole files")
        tables.append(("Whole files, on all cores", files.table(size, environment)))
    if "cliffs" in sections:
        race.say("cliffs")
        table = tuple(cliffs.table(2 * size.rows // 5, size.repeats))
        tables.append(("Hard streams beside their quiet neighbours", table))
    other: Sequence[str] = ()
    if "differences" in sections:
        race.say("where the peers read otherwise")
        other = differences.table(environment)
    absent = dict(environment.missing)
    if r2u2 is None:
        absent["R2U2"] = "the package index has none; `--r2u2` with a clone of its repository"
    left = [TITLES.get(one, one) for one in SECTIONS if one not in sections]
    if left:
        absent["sections"] = "; ".join(left)
    return Findings(
        command,
        environment.versions,
        tuple(results),
        tuple(agreements),
        tuple(other),
        tuple(tables),
        absent,
        round((time.monotonic() - began) / 60),
    )


def parser_of(about: str | None, sections: Sequence[str]) -> argparse.ArgumentParser:
    """The options of a program that measures some sections."""
    parser = argparse.ArgumentParser(description=(about or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a few minutes, for a first look")
    parser.add_argument("--only", nargs="+", choices=sections, default=sections, metavar="SECTION")
    parser.add_argument("--r2u2", type=Path, help="a clone of its repository", metavar="FOLDER")
    parser.add_argument("--out", type=Path, metavar="FILE", help="write the page there")
    return parser


def show(program: str, argv: Sequence[str], options: argparse.Namespace) -> int:
    """Measure, and write the page, or print it."""
    shown = ["FOLDER" if Path(one) == options.r2u2 else one for one in argv]
    command = " ".join([f"python -m benchmarks.{program}", *shown])
    page = render(run(QUICK if options.quick else Size(), options.only, command, options.r2u2))
    if options.out is None:
        print(page)
        return 0
    options.out.write_text(page, encoding="utf-8")
    race.say(f"wrote {options.out}")
    return 0


def main(argv: Sequence[str]) -> int:
    parser = parser_of(__doc__, SECTIONS)
    parser.set_defaults(out=OUT)
    return show("results", argv, parser.parse_args(argv))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
