"""Closure: tests are made, played and looked at until nothing is left that a test could show.

`close` is the loop; `goals` says what is open, `witnesses` asks the model for tests and proofs,
`mutate` changes the nearest test (`nearest`), and `learned` says which changes have paid.
"""

from rvmon.cdv.close.close import Budget, close
from rvmon.cdv.close.outcome import Added, Closed

__all__ = ["Added", "Budget", "Closed", "close"]
