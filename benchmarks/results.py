"""The page of results: what the product costs beside all peers, and what grows how.

    python -m benchmarks.results [--quick] [--only SECTION …] [--r2u2 FOLDER] [--out FILE]

Runs `online`, `recordings`, the cliffs of `growth`, and the table of where peers read otherwise.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from benchmarks.growth import cliffs
from benchmarks.page import TITLES, Findings, findings_of, render
from benchmarks.peers import differences
from benchmarks.peers.environment import prepare
from benchmarks.peers.native import build
from benchmarks.timing.measure import QUICK, Size

from benchmarks import online, recordings

OUT = Path(__file__).with_name("RESULTS.md")
SECTIONS = (*online.SECTIONS, *recordings.SECTIONS, "cliffs", "differences")


def run(size: Size, sections: Sequence[str], command: str, r2u2: Path | None) -> Findings:
    """Measure all chosen sections."""
    began = time.monotonic()
    environment = prepare()
    native = build(environment)
    own = [one for one in sections if one in online.SECTIONS]
    results, agreements = online.run(size, own, environment, native, r2u2)
    own = [one for one in sections if one in recordings.SECTIONS]
    more, agreed, files = recordings.run(size, own, environment, native)
    tables = [("Whole files, on all cores", files)] if files else []
    if "cliffs" in sections:
        online.say("cliffs")
        table = tuple(cliffs.table(2 * size.rows // 5, size.repeats))
        tables.append(("Hard streams beside their quiet neighbours", table))
    other: Sequence[str] = ()
    if "differences" in sections:
        online.say("where the peers read otherwise")
        other = differences.table(environment)
    found = findings_of(command, environment, [*results, *more], [*agreements, *agreed])
    absent = dict(found.absent)
    if r2u2 is None:
        absent["R2U2"] = "the package index has none; `--r2u2` with a clone of its repository"
    if native.binary is None:
        absent["reelay C++"] = native.reason
    left = [TITLES.get(one, one) for one in SECTIONS if one not in sections]
    if left:
        absent["sections"] = "; ".join(left)
    minutes = (time.monotonic() - began) / 60
    return replace(
        found,
        minutes=round(minutes),
        differences=tuple(other),
        tables=tuple(tables),
        absent=absent,
    )


def main(argv: Sequence[str]) -> int:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="a few minutes, for a first look")
    parser.add_argument("--only", nargs="+", choices=SECTIONS, default=SECTIONS, metavar="SECTION")
    parser.add_argument("--r2u2", type=Path, help="a clone of its repository", metavar="FOLDER")
    parser.add_argument("--out", type=Path, default=OUT, metavar="FILE")
    options = parser.parse_args(argv)
    shown = ["FOLDER" if Path(one) == options.r2u2 else one for one in argv]
    command = " ".join(["python -m benchmarks.results", *shown])
    size = QUICK if options.quick else Size()
    findings = run(size, options.only, command, options.r2u2)
    options.out.write_text(render(findings), encoding="utf-8")
    online.say(f"wrote {options.out}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
