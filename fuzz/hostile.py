"""Recordings that are wrong here and there, judged by columns and by samples.

    python -m fuzz.hostile --inputs 100000 --seed 1

Each is a few rows or lines whose values, stamps, commas and ends are seldom what they should be: so
that, unlike most that a fuzzer makes of bytes, many are judged. Prints how many; at the first on
which both disagree it ends, with the file.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from pathlib import Path

from fuzz.targets import ENDS, TIMES, recording

CELLS = {
    "door": ("0", "1", "true", "False"),
    "speed": ("0.05", "1e-2", "3", "nan", "-0.1", "12345.678901234567", "inf", "4.9e-324"),
    "parts": ("0", "2", "-7", "3"),
    "mode": ("idle", "working", "stopped"),
    "pick": ("1", "0", "true"),
    "pick.id": ("3", "4"),
    "pick.force": ("4.5", "4.75", "nan"),
    "halt": ("1", "0", "True"),
    "x": ("what ever", '"so ""so"""', '"a,b"'),
}
"""What columns may hold."""

VALUES = {
    **{
        name: tuple(one for one in CELLS[name] if one not in ("nan", "inf"))
        for name in ("speed", "parts")
    },
    "door": ("true", "false"),
    "mode": ('"idle"', '"working"'),
    "pick": ('{"id": 3, "force": 4.75}', '{"id":4}', "true", "false", '{"id":3,"force":null}'),
    "halt": ("true", "false"),
    "events": ('["halt"]', '["halt","x"]', "[]"),
    "x": ("[1,{}]", '{"y":"\\u00e9"}', "null"),
}
"""What fields may hold."""

HOSTILE = (
    *("", " ", "0.0", "-0", "+1", "1.", ".5", "01", "1e400", "-1e400", "0x1", "1_0", "NaN", "null"),
    *(
        "9007199254740993",
        "99999999999999999999",
        "1e-400",
        "TRUE",
        "t",
        '"',
        '""',
        "''",
        "\\u0000",
    ),
    *("\x00", "\u00e9", "\ud7ff", "\ufeff", "\r", "\n", ",", "{}", "[]", '"idle', "[" * 40, "--1"),
)
"""What stands in place of a value now and then."""

STEPS = (0, *(1, 50_000_000, 123_456_789, 300_000_000, 300_000_001, 900_000_000) * 3)


def made(rng: random.Random) -> bytes:
    form, model = rng.randrange(len(ENDS)), rng.randrange(len(TIMES))
    lines = _csv(rng) if ENDS[form] == ".csv" else _json(rng)
    text = rng.choice(("\n", "\n", "\n", "\r\n")).join(lines) + rng.choice(("\n", ""))
    data = bytearray(text.encode("utf-8", "surrogatepass"))
    if rng.random() < 0.05 and data:
        data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes([form + 2 * model]) + bytes(data)


def _stamps(rng: random.Random) -> list[int]:
    t = rng.choice((0, 0, 1_700_000_000 * 10**9, -5 * 10**9))
    stamps = []
    for _ in range(rng.randint(0, 12)):
        t += rng.choice(STEPS)
        stamps.append(t if rng.random() > 0.003 else rng.choice((t - 1, -(1 << 62), 1 << 63)))
    return stamps


def _value(rng: random.Random, usual: tuple[str, ...]) -> str:
    return rng.choice(usual if rng.random() > 0.002 else HOSTILE)


def _csv(rng: random.Random) -> list[str]:
    names = [name for name in CELLS if rng.random() < 0.8]
    stamp = rng.choice(("t", "t_ns"))
    lines = [",".join([stamp, *names])]
    for t in _stamps(rng):
        cells = [_value(rng, CELLS[name]) if rng.random() < 0.5 else "" for name in names]
        lines.append(",".join([_decimal(t) if stamp == "t" else str(t), *cells]))
    return lines


def _decimal(t: int) -> str:
    sign = "-" if t < 0 else ""
    return f"{sign}{abs(t) // 10**9}.{abs(t) % 10**9:09d}"


def _json(rng: random.Random) -> list[str]:
    lines = []
    for t in _stamps(rng):
        names = [name for name in VALUES if rng.random() < 0.4]
        fields = [f'"{name}":{_value(rng, VALUES[name])}' for name in names]
        lines.append("{" + ",".join([f'"t_ns":{t}', *fields]) + "}")
    return lines


def main(words: list[str]) -> int:
    """Judge, count, print, and return 1 at the first disagreement."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--inputs", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(words)
    ends: Counter[str] = Counter()
    began = time.process_time()
    for number in range(options.inputs):
        data = made(random.Random(f"{options.seed}/{number}"))
        try:
            ends[recording(data)] += 1
        except Exception as error:  # noqa: BLE001 - this is what is looked for
            kept = Path(f"hostile-{options.seed}-{number}")
            kept.write_bytes(data)
            print(f"{kept}: {type(error).__name__}: {error}")
            return 1
    print(f"{options.inputs:,} recordings, {time.process_time() - began:.0f} s of CPU time")
    for end, count in ends.most_common():
        print(f"  {count:>9,} {end}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
