"""The core's memory with each block by itself, so that AddressSanitizer sees one step beyond it."""

from __future__ import annotations

from pathlib import Path

_CORE = Path(__file__).parents[2] / "src" / "rvmon" / "core" / "native"
_GROWN = "void *widened("


def guarded_memory() -> str:
    """The C that takes the place of the core's memory.c, which puts many blocks into one."""
    _, found, grown = (_CORE / "memory.c").read_text(encoding="utf-8").partition(_GROWN)
    if not found or grown.count("\n}\n") != 2:
        raise ValueError(f"memory.c does not end with `{_GROWN}…`")
    guarded = Path(__file__).with_suffix(".c").read_text(encoding="utf-8")
    return f"{guarded}\n{found}{grown}"
