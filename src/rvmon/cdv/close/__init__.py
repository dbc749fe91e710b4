"""Closure: tests are made, played and looked at until nothing is left that a test could show.

`close` is the loop; `goals` says what is open and asks the model for tests and proofs, `vary_test`
changes the nearest test and says which changes have paid, `propose` chooses among them.
"""

from rvmon.cdv.close.close import Budget, close
from rvmon.cdv.close.outcome import Added, Closed

__all__ = ["Added", "Budget", "Closed", "close"]
