"""Logs of PX4 and of CAN, written as their tools do: a speed and a mode over time."""

import struct
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

Row = tuple[int, float, int]
"""Microseconds, a speed, a mode."""

DBC = """VERSION ""
NS_ :
BS_:
BU_: ECU
BO_ 100 Drive: 5 ECU
 SG_ speed : 0|32@1- (1,0) [0|0] "m/s" ECU
 SG_ mode : 32|8@1+ (1,0) [0|255] "" ECU
SIG_VALTYPE_ 100 speed : 1;
"""
"""Says what frames of CAN hold."""


def write_ulog(path: Path, rows: Sequence[Row], drops: Sequence[tuple[int, int]] = ()) -> Path:
    """A log of PX4; `drops` are behind how many messages something was dropped, for how many ms."""

    def message(kind: bytes, body: bytes) -> bytes:
        return struct.pack("<H", len(body)) + kind + body

    parts = [b"ULog\x01\x12\x35\x01" + struct.pack("<Q", rows[0][0])]
    parts.append(message(b"F", b"drive:uint64_t timestamp;float speed;uint8_t mode;"))
    parts.append(message(b"A", struct.pack("<BH", 0, 0) + b"drive"))
    for place, row in enumerate(rows):
        parts.append(message(b"D", struct.pack("<HQfB", 0, *row)))
        parts += [message(b"O", struct.pack("<H", ms)) for at, ms in drops if at == place]
    path.write_bytes(b"".join(parts))
    return path


def write_can(path: Path, rows: Sequence[Row], said: Mapping[int, int] = {}) -> Path:
    """A log of CAN, by its ending, with the database beside it; objects of BLF behind some rows."""
    import can

    (path.parent / "car.dbc").write_text(DBC)
    writer: Any = can.Logger(path)
    with writer:
        for place, (t, speed, mode) in enumerate(rows, 1):
            data = struct.pack("<fB", speed, mode)
            writer(
                can.Message(
                    timestamp=t / 1e6,
                    arbitration_id=100,
                    data=data,
                    is_extended_id=False,
                    channel=1,
                )
            )
            if place in said:
                writer._add_object(said[place], bytes(24), t / 1e6)
    return path
