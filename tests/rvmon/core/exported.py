"""Runs cases with the exported C (`judge.c`) and with the extension, printed in one format."""

import struct
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from msgspec.structs import replace

from rvmon.core.c_files import core_files, plan_files, prefix_of
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.packed_plan import PlannedCore, planned_core
from rvmon.monitor.records import NUMBER, RECORD
from rvmon.monitor.requirement_plans import plan_alone
from rvmon.testing.generate.trace import Case
from rvmon.trace.sample import Sample, Scalar, Value
from rvmon.trace.schema import Kind

DRIVER = Path(__file__).parent / "judge.c"
HEAP = -1
_NO_TIME = -(1 << 63)
_SAYS_NO, _SAYS_UNKNOWN, _SAYS_YES = range(3)
_UNKNOWN, _WHOLE, _REAL = range(3)


class Exported:
    """A program of exported C that holds the plan of each case.

    Args:
        folder: where the program is built.
        cases: their specifications are ones that the core can judge.
        command: the compiler and its options.
        core: object file of the core, compiled by the same command.
    """

    def __init__(
        self, folder: Path, cases: Sequence[Case], command: Sequence[str], core: Path
    ) -> None:
        self.cases = cases
        self._compiled = [
            compile_spec(replace(case.spec, name=f"case {number}"))
            for number, case in enumerate(cases)
        ]
        self.planned = [planned_core(one) for one in self._compiled]
        self._program = folder / "judge"
        names, texts = [], core_files()
        for one in self._compiled:
            texts |= plan_files(plan_alone(one))
            names.append(prefix_of(one.checked.name))
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="utf-8")
        (folder / "plans.h").write_text(_plans(names))
        self.compile(command, core)

    def compile(self, command: Sequence[str], core: Path) -> None:
        """Compile the driver and the plans, and link them with an object file of the core."""
        line = [*command, "-I.", str(DRIVER), str(core), "-o", self._program.name, "-lm"]
        subprocess.run(line, cwd=self._program.parent, check=True)  # noqa: S603

    def judge(
        self, runs: Sequence[tuple[int, int]], reserved: int = 0, *, notes: bool = False
    ) -> list[list[str]]:
        """Lines printed for each run: one monitor judges the case, is reset, and judges it again.

        Args:
            runs: number of a case, and size of the memory block; `HEAP` for a heap, `HEAP - 1 - n`
                for a heap that grants n allocations.
            reserved: number of open attempts to reserve memory for.
            notes: whether notes are kept and read.
        """
        lines = (line for run in runs for line in self._lines(*run, reserved, notes=notes))
        script = "\n".join(lines) + "\n"
        done = subprocess.run(  # noqa: S603
            [self._program], input=script, check=True, stdout=subprocess.PIPE, text=True
        )
        *found, rest = done.stdout.split(".\n")
        assert not rest
        return [text.splitlines() for text in found]

    def _lines(self, number: int, size: int, reserved: int, *, notes: bool) -> Iterator[str]:
        case, planned = self.cases[number], self.planned[number]
        yield f"c {number} {size}"
        if notes:
            yield "n 0"
        yield f"m {reserved}"
        for name, place in planned.numbers.items():
            if case.names is not None and name not in case.names:
                yield f"a {place}"
        actions = list(self._actions(number))
        yield from [*actions, "r 0", *actions, "z 0"]

    def _actions(self, number: int) -> Iterator[str]:
        case, planned = self.cases[number], self.planned[number]
        for action in case.actions:
            if isinstance(action, Sample):
                for name, value in action.values.items():
                    yield from _update(planned, name, value)
                yield f"s {action.t}"
            else:
                yield f"w {action}"
        yield f"e {_NO_TIME if case.end is None else case.end}"

    def records_of_extension(self, number: int) -> list[str]:
        """The extension's records of a case, formatted as `judge.c` prints them."""
        case, planned = self.cases[number], self.planned[number]
        names = frozenset(planned.numbers)
        monitor = planned.monitor(names - (names if case.names is None else case.names))
        for action in case.actions:
            if isinstance(action, Sample):
                assert monitor.judge(action.t, planned.plain(action.t, action.values), True)
            else:
                monitor.advance(action)
        monitor.finish(case.end)
        records, numbers, *_ = monitor.records()
        rows = np.frombuffer(records, RECORD)
        values = np.frombuffer(numbers, NUMBER).reshape(len(rows), -1 if len(rows) else 0)
        return [_record(*one) for one in zip(rows, values, strict=True)]


def core_in(command: Sequence[str], folder: Path) -> None:
    """Compile the core to `rvmon_core.o` in a folder."""
    for name, text in core_files().items():
        (folder / name).write_text(text, encoding="utf-8")
    line = [*command, "-c", "rvmon_core.c", "-o", "rvmon_core.o"]
    subprocess.run(line, cwd=folder, check=True)  # noqa: S603


def _plans(names: Sequence[str]) -> str:
    """A header that includes all plans and lists them in a table."""
    includes = [f'#include "{name}_plan.c"' for name in names]
    rows = [f"    {{{name}_plan, sizeof {name}_plan}}," for name in names]
    table = ["static const struct { const uint64_t *bytes; size_t size; } plans[] = {", *rows, "};"]
    return "\n".join([*includes, *table]) + "\n"


def _update(planned: PlannedCore, name: str, value: Value) -> Iterator[str]:
    """The lines of an update."""
    for number, says, known, fields in updates_of(planned, name, value):
        yield f"u {number} {says} {_text(known)}"
        for place, field in enumerate(fields):
            yield f"f {place} {_text(field)}"


def _text(number: tuple[int, int]) -> str:
    kind, bits = number
    return f"{kind} {bits & 0xFFFF_FFFF_FFFF_FFFF:x}"


Update = tuple[int, int, tuple[int, int], list[tuple[int, int]]]
"""The number of a name, the kind of update, the value of a signal, the fields of a payload."""


def updates_of(planned: PlannedCore, name: str, value: Value) -> Iterator[Update]:
    """The updates for a value in the form of the core, one for each payload."""
    number, packed = planned.numbers[name], planned.packed
    if name in packed.signals:
        known = _number(value, packed.signals[name], packed.labels)
        yield number, _SAYS_UNKNOWN if known[0] == _UNKNOWN else _SAYS_YES, known, []
    elif value is None or value == () or isinstance(value, bool):
        says = _SAYS_UNKNOWN if value is None else _SAYS_YES if value else _SAYS_NO
        yield number, says, (_UNKNOWN, 0), []
    else:
        kinds = {field: kind for (event, field), kind in packed.fields.items() if event == name}
        for payload in value if isinstance(value, tuple) else (value,):
            assert isinstance(payload, Mapping)
            fields = [_number(payload.get(one), kinds[one], packed.labels) for one in kinds]
            yield number, _SAYS_YES, (_UNKNOWN, 0), fields


def _number(value: Scalar | Any, kind: Kind, labels: Mapping[str, int]) -> tuple[int, int]:
    """The kind and the bits, as a signed integer, of a value as in `rv_number`."""
    if value is None or value != value:
        return _UNKNOWN, 0
    if kind is Kind.REAL:
        (bits,) = struct.unpack("=q", struct.pack("=d", value))
        return _REAL, bits
    return _WHOLE, labels[str(value)] if kind is Kind.LABEL else int(value)


def _record(row: Any, values: Any) -> str:
    names = ("triggered", "decided", "requirement", "number", "verdict", "decision", "in_doubt")
    captured = [
        f"{value['kind']}:{int(value['bits']) & 0xFFFF_FFFF_FFFF_FFFF:x}"
        for value in values
        if row["captured"] >= 0 and value["kind"] != _UNKNOWN
    ]
    return " ".join(["r", *(str(row[name]) for name in names), *captured])
