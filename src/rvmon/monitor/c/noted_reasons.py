"""The reasons of decisions of compiled C, from the numbers that it noted."""

from __future__ import annotations

from array import array
from collections.abc import Mapping, Sequence
from typing import Any

from rvmon.codegen.c_online import NOT_YET
from rvmon.monitor.attempts.network_letters import journal_of
from rvmon.monitor.c.exchange_rules import letters_of
from rvmon.monitor.compiled.requirement import CompiledRequirement
from rvmon.monitor.records.deferred_reasons import DeferredReasons
from rvmon.monitor.records.explain_network import Noted, network_details
from rvmon.verdict.attempt import Attempt

_WORDS_OF_ENTRY = 2


class NotedReasons(DeferredReasons):
    """Tells of decisions of compiled C; `note_decision` of `beside.c.in` has the order."""

    def __init__(self, compiled: CompiledRequirement, *further: Any) -> None:
        super().__init__(compiled, *further)
        by_machine = compiled.engine("auto") == "automaton"
        self.details = self._of_machine if by_machine else self._of_network

    def _of_machine(self, attempt: Attempt, words: bytes) -> Mapping[str, Any]:
        seen, t, letter, position, location, clocks, *rest = array("q", words)
        before = (location, tuple(rest[:clocks]))
        kept = _instants(rest[clocks:], len(self.leaves) + 2 * len(self.places))
        return self._details(attempt, (seen, t, before, letter, letter, position, *kept))

    def _of_network(self, attempt: Attempt, noted: tuple[bytes, bytearray]) -> Mapping[str, Any]:
        words, book = noted
        seen_then, t, count, position, _, _, *rest = array("q", words)
        kept = _instants(rest, len(self.leaves) + 2 * len(self.places))
        seen, flow = self.stood(kept, position)
        plan, triggered = self.compiled.network_plan, attempt.triggered
        entries = array("q", book[: 8 * _WORDS_OF_ENTRY * count])
        letters = letters_of(entries, len(plan.leaves))
        journal = journal_of(plan, self.compiled.gap, letters, triggered)
        journal.grow(None, 2 * t + 1)
        read = self.unpacked(seen_then), seen, self.texts
        return network_details(
            attempt,
            Noted(self.compiled, journal, len(journal), triggered, *read, {}, flow, t),
        )


def _instants(words: Sequence[int], first: int) -> list[int | None]:
    """The same, where from one on instants stand, of which some have not been."""
    return [*words[:first], *(None if one == NOT_YET else one for one in words[first:])]
