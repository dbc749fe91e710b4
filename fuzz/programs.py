"""The reader of C programs under AFL++, with what finds wrong addresses and undefined behaviour.

What it calls a hang is counted and kept, and is no defect by itself: where a stamp leaps by years,
as many attempts fail as the law says, one for each second.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path
from struct import pack

from fuzz.targets import ENDS, RECORDED, TIMES

from rvmon.cli import main

FORMS = {"c_csv": ".csv", "c_jsonl": ".jsonl", "c_bin": ".bin"}
"""Targets, and the ending by which a program knows the form of a recording."""

CORPUS = Path(__file__).with_name("corpus") / "recording"

SETTINGS = {
    "AFL_NO_UI": "1",
    "AFL_SKIP_CPUFREQ": "1",
    "AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES": "1",
    "AFL_AUTORESUME": "1",
    "AFL_NO_AFFINITY": "1",
}


def fuzz_program(name: str, out: Path, seconds: int) -> tuple[int, str, str, tuple[Path, ...]]:
    """Have AFL++ change recordings of a form for so many seconds.

    Returns:
        How many there were, what was reached, how they ended, and those that end the program.
    """
    out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "p.rv").write_text(RECORDED.format(time=TIMES[0]))
        flags = "-fsanitize=address,undefined -fno-sanitize-recover=all -DBLOCK=100"
        before = dict(os.environ)
        os.environ["CC"] = f"afl-clang-fast {flags}"
        try:
            assert main(["build", str(folder / "p.rv"), "-o", str(folder / "judge")]) == 0
        finally:
            os.environ.clear()
            os.environ.update(before)
        _seeds(FORMS[name], folder / "seeds")
        words = ["afl-fuzz", "-i", str(folder / "seeds"), "-o", str(out / name)]
        words += ["-e", FORMS[name][1:], "-V", str(seconds), "-m", "none"]
        words += ["--", str(folder / "judge"), "--allow-missing", "@@"]
        known = set((out / name).glob("default/crashes*/id*"))
        with (out / f"{name}.txt").open("w") as log:
            subprocess.run(words, stdout=log, stderr=log, env=os.environ | SETTINGS, check=False)
    stats = dict(
        [part.strip() for part in line.split(":", 1)]
        for line in (out / name / "default" / "fuzzer_stats").read_text().splitlines()
    )
    reached = f"{stats['edges_found']} of {stats['total_edges']} edges ({stats['bitmap_cvg']})"
    slow = len([*(out / name).glob("default/hangs/id*")])
    bad = set((out / name).glob("default/crashes*/id*")) - known
    ended = f"{slow} took more than a second, in all so far"
    return int(stats["execs_done"]), reached, ended, tuple(sorted(bad))


def _seeds(ending: str, folder: Path) -> None:
    folder.mkdir()
    for path in CORPUS.iterdir():
        kind, *text = path.read_bytes()
        if ENDS[kind % 2] == ending:
            (folder / path.name).write_bytes(bytes(text))
    if ending == ".bin":
        (folder / "binary").write_bytes(binary())


def binary() -> bytes:
    """A recording in the fixed layout, of all kinds of columns."""
    names = ("door", "speed", "parts", "mode", "pick.id", "pick.force", "halt")
    head = b"rvmonbin" + pack("=I", len(names))
    head += b"".join(pack("=I", len(name)) + name.encode() for name in names)
    rows = (
        (0, (1, 0.05, 2, 0, 0, 0, 0), (3, 3, 3, 3, 1, 1, 3)),
        (10**8, (0, 0, 0, 1, 3, 4.75, 0), (3, 2, 0, 3, 3, 3, 1)),
        (2 * 10**9, (0, 0, 5, 2, 4, 1, 0), (0, 0, 3, 2, 3, 2, 3)),
    )
    return head + b"".join(
        pack("=q", t) + pack(f"={len(names)}d", *values) + bytes(states)
        for t, values, states in rows
    )
