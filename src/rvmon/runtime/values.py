"""Truth values, the locations of a decided attempt, and what stands for no instant."""

from __future__ import annotations

from rvmon.automaton.location import FAILED as FAILED
from rvmon.automaton.location import NOW as NOW
from rvmon.automaton.location import PASSED as PASSED
from rvmon.formula.state import FALSE as FALSE
from rvmon.formula.state import TRUE as TRUE
from rvmon.formula.state import UNKNOWN as UNKNOWN
from rvmon.trace.time import NEVER as NEVER
