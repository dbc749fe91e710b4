"""Logs of vehicles and measurements that only these tests write; others are in `tests.tools`."""

import io
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from tests.tools.logs import Row, write_can, write_ulog

import rvmon


def write_csv(path: Path, rows: Sequence[Row], prefix: str) -> Path:
    """The same as rows of a table."""
    lines = [f"t_ns,{prefix}.speed,{prefix}.mode"]
    lines += [f"{t * 1_000},{speed!r},{mode}" for t, speed, mode in rows]
    path.write_text("\n".join(lines) + "\n")
    return path


def write_dataflash(path: Path, rows: Sequence[Row], letter: str = "f") -> Path:
    """A log of ArduPilot; `C` writes speeds as hundredths."""

    def form(number: int, length: int, name: str, letters: str, columns: str) -> bytes:
        texts = (name.encode(), letters.encode(), columns.encode())
        return b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", number, length, *texts)

    parts = [form(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns")]
    layout = "<QfB" if letter == "f" else "<QHB"
    parts.append(form(1, 3 + struct.calcsize(layout), "DRV", f"Q{letter}B", "TimeUS,speed,mode"))
    parts += [b"\xa3\x95\x01" + struct.pack(layout, *row) for row in rows]
    path.write_bytes(b"".join(parts))
    return path


def write_tlog(path: Path, rows: Sequence[Row]) -> Path:
    """Telemetry: `speed` is the heading of VFR_HUD's air speed, `mode` its throttle."""
    from pymavlink.dialects.v20 import ardupilotmega

    link = ardupilotmega.MAVLink(io.BytesIO(), srcSystem=1, srcComponent=1)
    with path.open("wb") as file:
        for t, speed, mode in rows:
            packet = link.vfr_hud_encode(speed, 0.0, 0, mode, 0.0, 0.0).pack(link)
            file.write(struct.pack(">Q", t) + packet)
    return path


def write_mdf(path: Path, rows: Sequence[Row]) -> Path:
    """A measurement of a vehicle."""
    import numpy as np
    from asammdf import MDF, Signal

    times = np.array([t / 1e6 for t, _, _ in rows])
    named: list[tuple[str, Any, str]] = [
        ("speed", np.array([speed for _, speed, _ in rows], np.float32), "m/s"),
        ("mode", np.array([mode for _, _, mode in rows], np.uint8), ""),
    ]
    with MDF(version="4.10") as file:
        signals = [Signal(own, times, name=name, unit=unit) for name, own, unit in named]
        file.append(signals, acq_name="drive", common_timebase=True)
        file.save(path, overwrite=True)
    return path


def write_hdf5(path: Path, rows: Sequence[Row]) -> Path:
    """Arrays in a group."""
    import h5py
    import numpy as np

    with h5py.File(path, "w") as file:
        group = file.create_group("drive")
        group["t"] = np.array([t for t, _, _ in rows], np.int64)
        group["t"].attrs["units"] = "us"
        group["speed"] = np.array([speed for _, speed, _ in rows], np.float32)
        group["speed"].attrs["units"] = "m/s"
        group["mode"] = np.array([[mode] for _, _, mode in rows], np.uint8)
    return path


def write_mat(path: Path, rows: Sequence[Row]) -> Path:
    """A structure of MATLAB."""
    import numpy as np
    from scipy.io import savemat

    columns = {
        "time": np.array([t / 1e6 for t, _, _ in rows]),
        "speed": np.array([speed for _, speed, _ in rows], np.float32),
        "mode": np.array([mode for _, _, mode in rows], np.uint8),
    }
    savemat(path, {"drive": columns})
    return path


FORMS = {
    "a.ulg": (write_ulog, "drive", "pyulog"),
    "a.bin": (write_dataflash, "DRV", "pymavlink"),
    "a.tlog": (write_tlog, "VFR_HUD", "pymavlink"),
    "a.asc": (write_can, "Drive", "can"),
    "a.blf": (write_can, "Drive", "can"),
    "a.log": (write_can, "Drive", "can"),
    "a.mf4": (write_mdf, "drive", "asammdf"),
    "a.h5": (write_hdf5, "drive", "h5py"),
    "a.mat": (write_mat, "drive", "scipy"),
}
"""By the name of a recording what writes it, what its topic is called, what reads it."""

SPEC = """
spec drive
signal {0}.speed : real [m/s]
signal {0}.mode : int

requirement R1
  always {0}.speed < 1.25 m/s
requirement R2
  upon {0}.mode == 3
  then within 20 ms {0}.speed < 0.5 m/s
requirement R3
  upon {0}.mode == 1
  then for 5 ms {0}.mode != 2
"""


def written(folder, name, rows):
    """A recording, and the specification that reads it."""
    write, topic, package = FORMS[name]
    pytest.importorskip(package)
    folder.mkdir(exist_ok=True)
    spec = rvmon.loads(SPEC.format(topic))
    if name == "a.tlog":
        own = {f"{topic}.speed": f"/{topic}.airspeed", f"{topic}.mode": f"/{topic}.throttle"}
        spec = spec.reading(columns=own)
    return write(folder / name, rows), spec


STEADY = [(t, 0.25, 0) for t in range(1_000_000, 1_300_000, 1_000)]
FEW = [(1_000_000 + 1_000 * n, 0.5, 1) for n in range(6)]
