"""Cases as bytes for core_replay.c: random ones, of which the core says what the law says.

python -m benchmarks.core_recording --pairs 2000 --seed 1 FILE
"""

from __future__ import annotations

import argparse
import struct
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from tests.tools.differential import cases_of, disagreements
from tests.tools.forms import Compiler, Maker

from rvmon.monitor import CompiledSpec
from rvmon.monitor.core.planned import PlannedCore, planned_core
from rvmon.testing.case import Case
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.trace.sample import Sample, Scalar, Value
from rvmon.trace.schema import Kind

_NO, _UNKNOWN, _YES = 0, 1, 2
_NO_TIME = -(1 << 63)
_NOTHING = (0, 0)

PROFILE = Profile(crowded=5, many=8, wide=20)
TRACES = TraceProfile(sparse=12, long=8)
TRACES_EACH = 4


def recorded(pairs: int, seed: object) -> bytes:
    """So many random cases, less those that the core does not judge, or judges otherwise."""
    return written(
        case
        for number in range(pairs // TRACES_EACH)
        for case in cases_of(
            f"{seed}/{number}", PROFILE, TRACES, TRACES_EACH, windows=15, letters=8
        )
    )


def written(cases: Iterable[Case]) -> bytes:
    """Cases, less those that the core does not judge, or not as the law has it."""
    found: list[bytes] = []
    compiler = Compiler()
    make = Maker("c", compiler)
    last: CompiledSpec | None = None
    for case in cases:
        if make(case) is None or disagreements(case, make):
            continue
        compiled = compiler(case.spec)
        planned = planned_core(compiled)
        words = [*_case(planned, case)]
        plan = planned.packed.data if compiled is not last else b""
        last = compiled
        found.append(struct.pack("<q", len(plan)) + plan + struct.pack(f"<{len(words)}q", *words))
    return struct.pack("<q", len(found)) + b"".join(found)


def _case(planned: PlannedCore, case: Case) -> Iterator[int]:
    absent = [
        number
        for name, number in planned.numbers.items()
        if case.names is not None and name not in case.names
    ]
    yield from (len(absent), *absent, _NO_TIME if case.end is None else case.end, len(case.actions))
    for action in case.actions:
        if isinstance(action, Sample):
            updates = [*_updates(planned, action.values)]
            yield from (0, action.t, len(updates), *(word for one in updates for word in one))
        else:
            yield from (1, action)


def _updates(planned: PlannedCore, values: Mapping[str, Value]) -> Iterator[Sequence[int]]:
    """Of each update: name, what it says, a number, how many fields, these."""
    for name, value in values.items():
        number, kind = planned.numbers[name], planned.packed.signals.get(name)
        if kind is not None:
            known = _number(planned, kind, value)  # type: ignore[arg-type]
            yield (number, _YES if known[0] else _UNKNOWN, *known, 0)
        elif isinstance(value, tuple):
            for payload in value:
                yield (number, _YES, *_NOTHING, *_payload(planned, name, payload))
        elif isinstance(value, Mapping):
            yield (number, _YES, *_NOTHING, *_payload(planned, name, value))
        else:
            yield (number, _UNKNOWN if value is None else _YES if value else _NO, *_NOTHING, 0)


def _payload(planned: PlannedCore, event: str, payload: Mapping[str, Scalar]) -> Sequence[int]:
    kinds = {field: kind for (of, field), kind in planned.packed.fields.items() if of == event}
    numbers = [_number(planned, kind, payload.get(field)) for field, kind in kinds.items()]
    return [len(numbers), *(word for one in numbers for word in one)]


def _number(planned: PlannedCore, kind: Kind, value: Scalar) -> tuple[int, int]:
    """Its kind and bits as `rv_number` has them."""
    if value is None or value != value:
        return _NOTHING
    if kind is Kind.REAL:
        return 2, struct.unpack("<q", struct.pack("<d", float(value)))[0]
    return 1, planned.packed.labels[str(value)] if kind is Kind.LABEL else int(value)


def main(words: list[str]) -> int:
    """Write the file."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.core_recording")
    parser.add_argument("file", type=Path)
    parser.add_argument("--pairs", type=int, default=2_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(words)
    options.file.write_bytes(recorded(options.pairs, options.seed))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
