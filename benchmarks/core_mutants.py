"""Mutation testing of the core's C code: does it contain a line that no test needs?

    python -m benchmarks.core_mutants --count 30 --seed 1 [--only FILE …]

For each file `--count` changes are drawn with a seed, evenly over their kinds. Each mutant is
compiled, linked with the other files, and judges recorded random cases on which oracle and core
agree (core_replay.c). It is killed if it gives other results, crashes or hangs. Those that do not
compile, or to the same code, do not count. Prints survivors and counts; exits 1 if one survives.
"""

from __future__ import annotations

import itertools
import random
import re
import struct
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from benchmarks.process import measured
from benchmarks.program import program
from tests.rvmon.core.exported import updates_of
from tests.tools.differential import cases_of, disagreements
from tests.tools.drive import Found, Lost, told
from tests.tools.forms import Compiler, Maker

from rvmon.cdv.mutation.python_mutants import Mutant
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.native import sources as core_sources
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.trace.sample import Sample, Value

ROOT = Path(__file__).resolve().parent.parent
CORE = Path(core_sources.FOLDER)
REPLAY = Path(__file__).with_name("core_replay.c")
FLAGS = ("-std=c99", "-O1", "-ffp-contract=off", "-w")
MOST_MEMORY = 2 << 30

_NO_TIME = -(1 << 63)

PROFILE = Profile(crowded=5, many=8, wide=20, amounts=20)
TRACES = TraceProfile(sparse=12, long=8, outages=25)
TRACES_EACH = 4


def recorded(pairs: int, seed: object) -> bytes:
    """Random cases as bytes: up to `pairs`, without those on which core and oracle differ."""
    found: list[bytes] = []
    compiler = Compiler()
    make = Maker("c", compiler)
    for number in range(pairs // TRACES_EACH):
        place, plan = f"{seed}/{number}", None
        for case in cases_of(place, PROFILE, TRACES, TRACES_EACH, windows=15, letters=8):
            if make(case) is None or disagreements(case, make):
                continue
            planned = planned_core(compiler(case.spec), measured=number % 3 == 0)
            plan = planned.packed.data if plan is None else b""  # once for all of its cases
            words = [*_case(planned, case)]
            found += [struct.pack("<q", len(plan)), plan, struct.pack(f"<{len(words)}q", *words)]
    return struct.pack("<q", len(found) // 3) + b"".join(found)


def _case(planned: PlannedCore, case: Case) -> Iterator[int]:
    there = planned.numbers.keys() if case.names is None else case.names
    absent = [number for name, number in planned.numbers.items() if name not in there]
    actions = [*told(case)]
    yield from (len(absent), *absent, _NO_TIME if case.end is None else case.end, len(actions))
    for action in actions:
        match action:
            case Sample(t, values):
                updates = [*_updates(planned, values)]
                yield from (0, t, len(updates), *itertools.chain(*updates))
            case Lost(names, t) | Found(names, t):
                lost = [planned.numbers[name] for name in sorted(names)]
                yield from (2 + isinstance(action, Found), t, len(lost), *lost)
            case _:
                yield from (1, action)


def _updates(planned: PlannedCore, values: Mapping[str, Value]) -> Iterator[Sequence[int]]:
    """For each update: number of the name, kind of update, value, number of fields, fields."""
    for name, value in values.items():
        for number, says, known, fields in updates_of(planned, name, value):
            yield number, says, *known, len(fields), *itertools.chain(*fields)


def sources() -> list[Path]:
    """The C files of the core, without the binding."""
    return [CORE / name for name in core_sources.core_files()]


class Trial:
    """The compiled core, in which the object of one file at a time is replaced by a mutant.

    Args:
        folder: empty.
        cases: from `recorded`.
        changed: the files that are mutated; the other files are compiled into one object.
    """

    def __init__(self, folder: Path, cases: bytes, changed: Sequence[Path]) -> None:
        self._folder = folder
        self._cases = folder / "cases"
        self._cases.write_bytes(cases)
        rest = folder / "rest.c"
        others = [path for path in sources() if path not in changed]
        rest.write_text("".join(f'#include "{path}"\n' for path in others))
        self._objects = {path: folder / f"{path.stem}.o" for path in (*changed, rest, REPLAY)}
        for path, made in self._objects.items():
            if not self._compiled(path, made):
                raise SystemExit(f"{path} does not compile")
        began = time.perf_counter()
        self._expected = self._said(folder / "core", list(self._objects.values()), 600.0)
        self._seconds = time.perf_counter() - began
        if self._expected is None:
            raise SystemExit("without a change, the core crashes or hangs")
        path = changed[0]
        if self.outcome(Mutant(path, 0, "", "", "", path.read_text("utf-8"))) != "same":
            raise SystemExit(f"{path.name} without a change is not the same")

    def outcome(self, mutant: Mutant) -> str:
        """`killed`, `survived`, or the reason why it does not count: `unbuilt`, `same`."""
        changed, made = self._folder / "mutant.c", self._folder / "mutant.o"
        changed.write_text(mutant.source, encoding="utf-8")
        if not self._compiled(changed, made):
            return "unbuilt"
        own = self._objects[mutant.path]
        if _code_of(made) == _code_of(own):
            return "same"
        objects = [made if one == own else one for one in self._objects.values()]
        said = self._said(self._folder / "mutated", objects, 5 + 10 * self._seconds)
        return "survived" if said == self._expected else "killed"

    def _compiled(self, source: Path, made: Path) -> bool:
        words = ["gcc", *FLAGS, f"-I{CORE}", "-c", str(source), "-o", str(made)]
        return subprocess.run(words, capture_output=True, check=False).returncode == 0

    def _said(self, program: Path, objects: Sequence[Path], most: float) -> str | None:
        words = ["gcc", *map(str, objects), "-lm", "-o", str(program)]
        subprocess.run(words, check=True, capture_output=True)
        done = measured([str(program), str(self._cases)], most, memory=MOST_MEMORY)
        return None if done.code else done.output


def _code_of(made: Path) -> bytes:
    """The machine code of an object, without the name of its source."""
    words = ["objdump", "-drs", "-j", ".text", "-j", ".rodata", str(made)]
    told = subprocess.run(words, capture_output=True, check=False).stdout
    return told.split(b"\n", 3)[-1]


_SWAPS = (
    ("comparison", r"(?<= )(<|<=|>|>=|==|!=)(?= )", ("<", "<=", ">", ">=", "==", "!=")),
    ("and/or", r"(?<= )(&&|\|\|)(?= )", ("&&", "||")),
    ("operator", r"(?<= )(\+|-)(?= (?!1\b))", ("+", "-")),
    ("constant", r"\b(true|false)\b", ("true", "false")),
    ("constant", r"\b(IS_TRUE|IS_FALSE)\b", ("IS_TRUE", "IS_FALSE")),
    ("constant", r"(?<=[ (])([01])(?=[;,) ])", ("0", "1")),
    ("operator", r"(?<= )(&|\|)(?= )", ("&", "|")),
    ("operator", r"(?<= )(\*|/)(?= )", ("*", "/")),
)
"""Kind, pattern, and words in pairs: each word is replaced by the other one of its pair."""

_NEGATED = re.compile(r"^\s+(?:\} else )?if (\(.+\)) \{$")
"""A condition on a single line."""

_DROPS = (
    ("off by one", r" [+-] 1\b(?!\])"),
    ("dropped not", r"!(?=[a-z(])"),
    ("dropped statement", r"(?<=^)\s+(?:break|continue);$"),
    ("dropped statement", r"^\s+[a-z][\w\->\[\].*]* (?:[-+|&]?=) [^;{}]*;$"),
    ("dropped statement", r"^\s+[a-z]\w*\([^;{}]*\);$"),
)


def c_mutants(path: Path) -> Iterator[Mutant]:
    """All possible changes of a C file, outside comments, directives and declarations."""
    source = path.read_text(encoding="utf-8")
    at = 0
    comment = False
    for number, line in enumerate(source.splitlines(keepends=True), start=1):
        begins, ends = "/*" in line, "*/" in line
        code = not (comment or begins or line.startswith(("#", "static const", "typedef")))
        if code and line.startswith(" "):
            for kind, start, end, text in _changes(line.rstrip("\n")):
                changed = source[: at + start] + text + source[at + end :]
                after = (line[:start] + text + line[end:]).strip()
                yield Mutant(path, number, kind, line.strip(), after, changed)
        comment = (comment or begins) and not ends
        at += len(line)


def _changes(line: str) -> Iterator[tuple[str, int, int, str]]:
    for kind, pattern, words in _SWAPS:
        for found in re.finditer(pattern, line):
            index = words.index(found[1])
            yield kind, found.start(1), found.end(1), words[index ^ 1]
    if whole := _NEGATED.match(line):
        yield "negated condition", whole.start(1), whole.end(1), f"(!{whole[1]})"
    for kind, pattern in _DROPS:
        for found in re.finditer(pattern, line):
            text = ";" if kind == "dropped statement" else ""
            yield kind, found.start(), found.end(), text


def draw(found: Iterable[Mutant], count: int, seed: int) -> list[Mutant]:
    """Draw a seeded sample, kinds in turn, in an order that depends on each mutant alone."""
    kinds: dict[str, list[Mutant]] = {}
    for mutant in found:
        kinds.setdefault(mutant.kind, []).append(mutant)
    for members in kinds.values():
        members.sort(key=lambda mutant: random.Random(f"{seed} {mutant.change}").random())
    rounds = itertools.chain.from_iterable(itertools.zip_longest(*kinds.values()))
    return [*itertools.islice(filter(None, rounds), count)]


def main(
    *,
    count: int = 30,
    seed: int = 1,
    pairs: int = 1_200,
    only: Sequence[str] = (*core_sources.core_files(),),
) -> int:
    """Try `count` changes of each file, or of some files."""
    total: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as directory:
        chosen = [CORE / name for name in only]
        trial = Trial(Path(directory), recorded(pairs, seed), chosen)
        for path in chosen:
            found: Counter[str] = Counter()
            possible = [*c_mutants(path)]
            for mutant in draw(possible, count, seed):
                outcome = trial.outcome(mutant)
                found[outcome] += 1
                if outcome == "survived":
                    print(f"survived  {mutant}", flush=True)
            total += found
            print(f"{path.name}: {_told(found)}, of {len(possible)}", flush=True)
    print(f"all: {_told(total)}")
    return 1 if total["survived"] else 0


def _told(found: Counter[str]) -> str:
    counted, other = found["killed"] + found["survived"], f"{found['same']} same"
    return f"{found['killed']} of {counted} killed, {other}, {found['unbuilt']} unbuilt"


if __name__ == "__main__":
    sys.exit(program(__doc__, main))
