"""`python -m rvmon`."""

import sys

from rvmon.cli import program

sys.exit(program())
