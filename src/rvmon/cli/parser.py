"""The parser of the command line."""

from __future__ import annotations

import argparse
from typing import NoReturn

from rvmon.diagnostics.shown import shown


class Parser(argparse.ArgumentParser):
    """A parser whose complaints show what was given without obeying it."""

    def error(self, message: str) -> NoReturn:
        """Say what is wrong, and leave with code 2."""
        super().error(shown(message))
