"""`python -m rvmon`."""

import sys

from rvmon.cli import main

sys.exit(main())
