"""Fuzz one target with atheris: inputs that reach new code of rvmon are kept and mutated further.

    python -m fuzz.one TARGET FOLDER [LIBFUZZER'S OPTIONS …]

The folder gets the inputs that are found, those that fail, and `answers.json`.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import atheris

EVERY = 200
"""The number of inputs after which the answers are written again."""


def main(name: str, folder: Path, options: list[str]) -> None:
    with atheris.instrument_imports(include=["rvmon"]):
        from fuzz.targets import ANSWERS, run, seeds

        for data in seeds(name):  # run them once so that lazy imports are instrumented, too
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
