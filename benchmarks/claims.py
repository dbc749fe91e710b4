"""Check the claims in the tables of `docs/claims.md`.

    python -m benchmarks.claims [--long] [--only WORD]

A row has the claim, the command, a regular expression with one group that finds the figure in the
output of the command (or `exit code`), the expected value and its tolerance: `exact`, `at least` or
`at most`. Every match has to hold. A command that several rows share runs once. The exit code is 0
if all claims hold, 1 if one does not, 2 if a row is malformed.
"""

from __future__ import annotations

import os
import re
import shlex
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from benchmarks.process import Cost, measured
from benchmarks.program import program

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "claims.md"
QUICK, LONG = "## In three minutes", "## In an hour"
EXIT_CODE = "exit code"
SHOWN_LINES = 8
"""The number of last lines of output that are printed for a failed claim."""

_CELL = re.compile(r"(?<!\\)\|")


class ClaimError(Exception):
    """A row of the page cannot be read; the text names line, cause and fix."""


@dataclass(frozen=True, slots=True)
class Claim:
    """One row of the page."""

    text: str  # the claim
    command: str  # checks it
    pattern: str  # finds the figure in the output; or `EXIT_CODE`
    expected: str  # a number, or a text for `exact`
    tolerance: str  # `exact`, `at least` or `at most`

    def holds_for(self, found: str) -> bool:
        """Whether a found figure fulfils the claim.

        >>> Claim("", "", "", "5", "at least").holds_for("5.4")
        True
        """
        if self.tolerance == "exact":
            return found == self.expected
        value, expected = (float(one.replace(",", "")) for one in (found, self.expected))
        return {"at least": value >= expected, "at most": value <= expected}[self.tolerance]


def claims_of(page: str, *, long: bool) -> list[Claim]:
    """The rows of the page's tables; with `long` those of the second section, too.

    Raises:
        ClaimError: a row does not have five cells, a valid pattern and a known tolerance.
    """
    claims, wanted = [], False
    for number, line in enumerate(page.splitlines(), 1):
        if line.startswith("## "):
            wanted = line == QUICK or (long and line == LONG)
        if not wanted or not line.startswith("| ") or line.startswith("| claim"):
            continue
        cells = [cell.strip().replace(r"\|", "|") for cell in _CELL.split(line)[1:-1]]
        if len(cells) != 5:
            raise ClaimError(f"line {number}: {len(cells)} cells; a claim has five")
        claim = Claim(cells[0], *(cell.strip("`") for cell in cells[1:]))
        try:
            groups = 1 if claim.pattern == EXIT_CODE else re.compile(claim.pattern).groups
            claim.holds_for(claim.expected)
        except (re.error, ValueError, KeyError) as error:
            raise ClaimError(f"line {number}: {error}") from None
        if groups != 1:
            raise ClaimError(f"line {number}: `{claim.pattern}` has {groups} groups; it needs one")
        claims.append(claim)
    return claims


def main(*, long: bool = False, only: str = "") -> int:
    """Check the claims that contain `only`, with `long` also the slow ones; print the results."""
    try:
        claims = claims_of(PAGE.read_text(encoding="utf-8"), long=long)
    except ClaimError as error:
        print(f"docs/claims.md: {error}", file=sys.stderr)
        return 2
    failed = 0
    chosen = [claim for claim in claims if only in claim.text + claim.command]
    for claim in chosen:
        began = time.perf_counter()
        lines = list(_complaints(claim))
        failed += bool(lines)
        word = "does not hold" if lines else "holds"
        print(f"{word:<13} {time.perf_counter() - began:6.1f} s  {claim.text}", flush=True)
        print("".join(f"  {line}\n" for line in lines), end="", flush=True)
    print(f"{len(chosen) - failed} passed, {failed} failed")
    return int(failed > 0 or not chosen)


def _complaints(claim: Claim) -> Iterator[str]:
    done = _ran(claim.command)
    findings = re.findall(claim.pattern, done.output + done.errors, re.MULTILINE)
    if claim.pattern == EXIT_CODE:
        findings = [str(done.code)]
    wrong = [found for found in findings if not claim.holds_for(found)]
    if findings and not wrong:
        return
    wanted = f"expected {claim.expected} ({claim.tolerance})"
    yield f"{wanted}, came {', '.join(wrong) or 'nothing that fits ' + claim.pattern}"
    yield f"$ {claim.command}"
    yield from (done.output + done.errors).splitlines()[-SHOWN_LINES:]


@cache
def _ran(command: str) -> Cost:
    """A command, run in the project's folder and environment, an hour at most."""
    path = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    with tempfile.TemporaryDirectory() as folder:
        words = [word.replace("OUT", folder, 1) for word in shlex.split(command)]
        environment = {**os.environ, "PATH": path, "COLUMNS": "100"}
        try:
            return measured(words, environment=environment, folder=ROOT)
        except OSError as error:
            return Cost(0, 0, 0, -1, "", str(error))


if __name__ == "__main__":
    sys.exit(program(__doc__, main))
