"""The C sources of the extensions, and a hash of them that tells a forgotten build.

The build hook runs this file alone: it imports nothing of rvmon.
"""

from __future__ import annotations

import os
import zlib

_PACKAGE = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
FOLDER = os.path.join(_PACKAGE, "core", "native")
ZONES_FOLDER = os.path.join(_PACKAGE, "models", "native")
CSV_FOLDER = os.path.join(_PACKAGE, "recordings", "native")
BLOCK = 1 << 17
"""Bytes that are read at once: more than any source has."""


def source_names(folder: str = FOLDER) -> list[str]:
    """All C files and headers in a folder, that of the core, and in those within, sorted."""
    found = []
    for name in os.listdir(folder):
        if name.endswith((".c", ".h")):
            found.append(name)
        elif "." not in name and name != "__pycache__":
            found += [f"{name}/{inner}" for inner in source_names(f"{folder}/{name}")]
    return sorted(found)


def source_hash(folder: str = FOLDER) -> str:
    """Hash of the names and contents of the C sources; empty where there are none.

    A checksum against forgotten builds, not against forgery: it is computed at each import, in
    2 ms for 870 kB in 118 files.
    """
    names = source_names(folder)
    value = 0
    for name in names:
        value = zlib.crc32(os.fsencode(name) + b":", value)
        # Not `open`, which would take longer than all the rest.
        file = os.open(f"{folder}/{name}", os.O_RDONLY | getattr(os, "O_BINARY", 0))
        try:
            while block := os.read(file, BLOCK):
                value = zlib.crc32(block, value)
                if len(block) < BLOCK:
                    break
        finally:
            os.close(file)
    return f"{value:08x}" if names else ""
