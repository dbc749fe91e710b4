"""The C sources of the native core, and a hash of them that tells a forgotten build.

The build hook runs this file alone: it imports nothing of rvmon.
"""

from __future__ import annotations

import os
import zlib

FOLDER = os.path.dirname(os.path.abspath(__file__))


def source_names(folder: str = FOLDER) -> list[str]:
    """Names of all C files and headers in the folder of the core, sorted."""
    return sorted(name for name in os.listdir(folder) if name.endswith((".c", ".h")))


def source_hash(folder: str = FOLDER) -> str:
    """Hash of the names and contents of the C sources; empty where there are none.

    A checksum against forgotten builds, not against forgery: it is computed at each import.
    """
    names = source_names(folder)
    value = 0
    for name in names:
        # Not `open`: without buffers and codecs this takes half the time.
        file = os.open(os.path.join(folder, name), os.O_RDONLY | getattr(os, "O_BINARY", 0))
        try:
            text = os.read(file, os.fstat(file).st_size)
        finally:
            os.close(file)
        value = zlib.crc32(text, zlib.crc32(b"%s:%d:" % (os.fsencode(name), len(text)), value))
    return f"{value:08x}" if names else ""
