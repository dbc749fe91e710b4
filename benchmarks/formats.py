"""Public logs against what the tools of their formats make of them: the records have to be equal.

    python -m benchmarks.formats ~/logs/*.ulg ~/logs/*.BIN ~/logs/*.tlog ~/logs/*.mf4

ULog is compared with the CSV of `ulog2csv`, DataFlash and tlog with the messages that `mavlogdump`
goes through, MDF with the channels of asammdf. Prints for each file how many messages were
compared, how many differ, and how many a second are read; exits with 1 if one differs. Numbers of
32 bits are compared as such: a CSV has fewer digits.
"""

from __future__ import annotations

import csv
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from rvmon.readers.messages.columns import path_of
from rvmon.readers.messages.fields import field_of, getter
from rvmon.readers.recording import messages_of

Row = tuple[int, Mapping[str, Any]]
"""Ticks, values by the path of the field."""


def ours(path: Path) -> tuple[dict[str, list[Row]], float]:
    """The messages by topic, with all their fields, and how many a second are read without."""
    source = messages_of(str(path))
    topics = {name for name, topic in source.topics.items() if not topic.fault}
    began = time.perf_counter()
    count = sum(1 for _ in source.read(topics))
    rate = count / (time.perf_counter() - began)
    found: dict[str, list[Row]] = {name: [] for name in topics}
    gets: dict[str, dict[str, Any]] = {}
    for name, t, content in source.read(topics):
        if name not in gets:
            leaves = [leaf.removesuffix("[]") for leaf in source.topics[name].leaves]
            fields = {leaf: field_of(leaf) for leaf in leaves if "[" not in leaf}
            gets[name] = {
                leaf: getter(field, mappings=isinstance(content, Mapping))
                for leaf, field in fields.items()
                if field is not None
            }
        values = {}
        for leaf, get in gets[name].items():
            with suppress(KeyError):
                values[leaf] = get(content)
        found[name].append((t, _spread(values) if path.suffix.lower() == ".ulg" else values))
    return found, rate


def _spread(values: Mapping[str, Any]) -> dict[str, Any]:
    """Each element of an array with its place, as `ulog2csv` writes it."""
    spread: dict[str, Any] = {}
    for name, value in values.items():
        if isinstance(value, list):
            spread |= {f"{name}[{place}]": one for place, one in enumerate(value)}
        else:
            spread[name] = value
    return spread


def is_same(own: Any, told: Any) -> bool:
    """Whether a value is what a tool says, in text or not."""
    if isinstance(own, list | tuple):
        return len(own) == len(told) and all(map(is_same, own, told))
    if own is None:
        return told in ("", None)
    if isinstance(own, str):
        return own == (told.decode() if isinstance(told, bytes) else str(told))
    number = float(told)
    return own == number or np.float32(own) == np.float32(number) or math.isnan(own + number)


def by_ulog2csv(path: Path) -> Iterator[tuple[str, list[Row]]]:
    """The rows of each topic; those without a stamp came nobody knows when."""
    with tempfile.TemporaryDirectory() as folder:
        program = Path(sys.executable).parent / "ulog2csv"
        subprocess.run([program, "-i", "-o", folder, path], check=True, capture_output=True)
        for file in sorted(Path(folder).glob("*.csv")):
            name, _, number = file.stem.removeprefix(f"{path.stem}_").rpartition("_")
            with file.open() as text:
                rows = sorted(csv.DictReader(text), key=lambda row: int(row["timestamp"]))
            yield (
                f"/{name}" + ("" if number == "0" else f"_{number}"),
                [(int(row.pop("timestamp")) * 1_000, row) for row in rows if int(row["timestamp"])],
            )


def by_mavlogdump(path: Path, topics: Mapping[str, Any]) -> Iterator[tuple[str, list[Row]]]:
    """The messages of each type, as `mavlogdump` goes through them."""
    from pymavlink import mavutil

    found: dict[str, list[Row]] = {}
    log = mavutil.mavlink_connection(str(path))
    while (message := log.recv_msg()) is not None:
        kind, values = message.get_type(), message.to_dict()
        if path.suffix.lower() == ".tlog":
            name = f"/sys{message.get_srcSystem()}_comp{message.get_srcComponent()}/{kind}"
            name = f"/{kind}" if f"/{kind}" in topics else name
            t = round(message._timestamp * 1e6) * 1_000
        else:
            scale = {"TimeUS": 1_000, "TimeMS": 1_000_000}
            stamp = next((one for one in scale if one in values), "")
            if "T" in values and kind.startswith("GPS"):
                stamp, scale = "T", {"T": 1_000_000}
            if not stamp:
                continue
            instance = message.fmt.instance_field
            name = f"/{kind}" if instance is None else f"/{kind}_{values.pop(instance)}"
            t = values.pop(stamp) * scale[stamp]
        del values["mavpackettype"]
        if name in topics:
            found.setdefault(name, []).append((t, values))
    for name, rows in found.items():
        yield name, sorted(rows, key=lambda row: row[0])


def by_asammdf(path: Path) -> Iterator[tuple[str, list[Row]]]:
    """The rows of each group; what is marked invalid is empty."""
    from asammdf import MDF

    with MDF(path) as file:
        for number, group in enumerate(file.groups):
            if not group.channel_group.cycles_nr:
                continue
            columns = {}
            for place, channel in enumerate(group.channels):
                if place == file.masters_db[number]:
                    continue
                signal = file.get(group=number, index=place)
                cells = [one.decode() if isinstance(one, bytes) else one for one in signal.samples]
                if signal.invalidation_bits is not None:
                    wrong = signal.invalidation_bits
                    cells = [None if bad else one for one, bad in zip(cells, wrong, strict=True)]
                columns[path_of(channel.name)] = cells
            times = [round(t * 1e9) for t in file.get_master(number).tolist()]
            acquired = group.channel_group.acq_name or group.channel_group.comment
            rows = [
                (t, {name: cells[place] for name, cells in columns.items()})
                for place, t in enumerate(times)
            ]
            yield f"/{path_of(acquired)}", rows


def compared(path: Path) -> tuple[int, int, float]:
    """How many messages were compared, how many differ, and how many a second are read."""
    found, rate = ours(path)
    match path.suffix.lower():
        case ".ulg":
            told = by_ulog2csv(path)
        case ".mf4":
            told = by_asammdf(path)
        case _:
            told = by_mavlogdump(path, found)
    count = wrong = 0
    for name, rows in told:
        own = found.get(name, [])
        wrong += abs(len(own) - len(rows))
        for (t, values), (expected, cells) in zip(own, rows, strict=False):
            count += 1
            known = {key: cell for key, cell in cells.items() if key in values}
            alike = all(is_same(values[key], cell) for key, cell in known.items())
            wrong += not alike or abs(t - expected) > 1 or len(known) < len(values)
    return count, wrong, rate


def main(argv: Sequence[str]) -> int:
    """Compare files, and print the figures."""
    differ = 0
    for name in argv:
        count, wrong, rate = compared(Path(name))
        differ += wrong
        print(f"{Path(name).name}: compared {count:,}, differ {wrong:,}, {rate:,.0f} messages/s")
    return int(bool(differ))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
