"""One target under atheris: inputs that reach new places of rvmon are kept and changed further.

    python -m fuzz.one TARGET FOLDER [LIBFUZZER'S OPTIONS …]

The folder takes the inputs that are found, those at which something stumbles, and `answers.json`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import atheris

EVERY = 200
"""Inputs between two times that the answers are written."""


def main(name: str, folder: Path, options: list[str]) -> None:
    with atheris.instrument_imports(include=["rvmon"]):
        from fuzz.targets import ANSWERS, run, seeds

        for data in seeds(name):  # imports what is imported late
            run(name, data)
    ANSWERS.clear()

    def take(data: bytes) -> None:
        run(name, data)
        if not ANSWERS.total() % EVERY:
            (folder / "answers.json").write_text(json.dumps(ANSWERS))

    atheris.Setup([name, *options], take)
    atheris.Fuzz()


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]), sys.argv[3:])
