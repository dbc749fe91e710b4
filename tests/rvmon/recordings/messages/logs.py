"""Logs of vehicles and measurements that only these tests write; others are in `tests.tools`."""

import io
import struct
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tests.tools.logs import Row


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
