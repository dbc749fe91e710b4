"""Fuzzes targets in turn, each for its part of the time, and says at what something stumbled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class Found:
    """What came of a target."""

    told: str  # how many inputs it took, and what they reached
    stumbled: Sequence[Path]  # inputs at which something was wrong


def fuzz(
    targets: Sequence[str], run: Callable[[str, Path, int], Found], out: Path, seconds: int
) -> int:
    """Run a fuzzer on some targets, and print what came of each; 1 if anything stumbled.

    Each has its part of the seconds, and a folder in `out` that keeps what is found.
    """
    code = 0
    for name in targets:
        folder = out.resolve() / name
        folder.mkdir(parents=True, exist_ok=True)
        found = run(name, folder, max(1, seconds // len(targets)))
        print(f"{name:12} {found.told}", flush=True)
        for path in found.stumbled:
            print(f"  stumbled over {path}")
            code = 1
    return code
