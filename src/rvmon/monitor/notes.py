"""Decodes the core's notes about attempts into reasons, deadlines, blame and forecasts."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, lru_cache, partial
from operator import getitem
from struct import Struct
from typing import Any, NamedTuple

from rvmon.logic.automaton import Token
from rvmon.logic.state_formula import UNKNOWN
from rvmon.logic.state_graph import names_of
from rvmon.monitor import explanation as explain
from rvmon.monitor.automaton_reasons import MachineRuns, Reasons, explained
from rvmon.monitor.cause import NEVER, TruthValues
from rvmon.monitor.compile import CompiledRequirement
from rvmon.monitor.compiled_spec import CompiledSpec
from rvmon.monitor.network_reasons import explained_by_network
from rvmon.monitor.network_replay import Letters, at_decision, at_moment, truths, words_for
from rvmon.trace.sample import HealthKind
from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Decision

# Kinds and flags of notes, as in `notes.h`.
_DECIDED, _OPEN, _NOTHING = 0, 1, 2
_NETWORK, _CUT, _PARTED, _CANNOT_PASS, _SURE = 1, 2, 4, 8, 16
_HEAD = 7  # words of a note before those of the leaves
_NOT_YET = (1 << 63) - 1  # the end of an outage that is still open
_SPAN = (1 << 31) - 1  # the bits of the number of a span of letters
_WHY = (
    *(HealthKind.NONE, HealthKind.NAN, HealthKind.STALE),
    *(HealthKind.MISSING, HealthKind.ABSENT),
)
"""Reasons for unknown input, by their numbers in `core.h` and `state.h`."""


class Note(NamedTuple):
    """A note of the core about an attempt; `write_notes.c` describes its words."""

    words: tuple[int, ...]  # the int64 words of the note
    # the words on leaves and propositions at the decision; empty if there are none
    state: tuple[int, ...]
    letters: Letters | None  # the letters a network was evaluated on; `None` for an automaton

    @property
    def kind(self) -> int:
        """`_DECIDED`, `_OPEN`, or `_NOTHING` for an attempt that can no longer be decided."""
        return self.words[0] & 0xFF

    @property
    def flags(self) -> int:
        """The flags `_NETWORK` to `_SURE`."""
        return self.words[0] >> 8 & 0xFFFF

    @property
    def judge(self) -> int:
        """The number of the attempt's judge in its part."""
        return self.words[0] >> 24 & 0xFFFF

    @property
    def at(self) -> int:
        """The instant of the decision, ticks; of an open attempt the current stamp."""
        return self.words[2]


def note_of(data: bytes, state: bytes | None, pieces: Any, last: bytes | None) -> Note:
    """A note from the parts that the core returns with a single attempt."""
    return Note(
        _words(len(data) // 8)(data),
        () if state is None else _words(len(state) // 8)(state),
        None if last is None else Letters((*pieces, last)),
    )


def note_at(notes: bytes, place: int, spans: Sequence[tuple[Any, bytes, int]]) -> Note:
    """The note that starts at word `place` of the notes of all records.

    `spans` are the letters that notes refer to by number, as the core returns them.
    """
    (head,) = _words(1)(notes, 8 * place)
    words = _words(head >> 40)(notes, 8 * place)
    state: tuple[int, ...] = ()
    if words[1] >= 0:
        (count,) = _words(1)(notes, 8 * words[1])
        state = _words(count)(notes, 8 * words[1])
    letters = None
    if head >> 8 & _NETWORK and words[3] >= 0:
        pieces, last, count = spans[words[3] & _SPAN]
        letters = Letters((*pieces, last[: 8 * count]))
    return Note(words, state, letters)


@lru_cache(maxsize=1024)
def _words(count: int) -> Callable[..., tuple[int, ...]]:
    """A function that unpacks `count` words from bytes at an offset."""
    return Struct(f"={count}q").unpack_from


@lru_cache(maxsize=1024)
def _by_text(texts: tuple[str, ...], then: tuple[int, ...]) -> Mapping[str, int]:
    """The truth at the trigger by text; cached, as most attempts share it."""
    return dict(zip(texts, then, strict=True))


class NoteExplainer:
    """Explains the attempts of one judge of the core from their notes."""

    def __init__(self, compiled: CompiledRequirement, gap: int | None) -> None:
        self.compiled = compiled
        self._gap = gap
        self._texts = tuple(text for _, text in compiled.leaves)
        self._leaf_words = words_for(len(self._texts))
        propositions = compiled.alphabet.propositions
        self._first = 2 + self._leaf_words + words_for(len(propositions))
        self._places = {
            state: (place, self._first + 3 * place) for place, state in enumerate(propositions)
        }

    @cached_property
    def _reasons(self) -> Reasons:
        return Reasons(self.compiled)

    def _then(self, note: Note) -> tuple[int, ...]:
        return truths(note.words[_HEAD : _HEAD + self._leaf_words], len(self._texts))

    def _truth_values(self, note: Note, origin: int) -> TruthValues:
        """The truth values of propositions at the decision, with their history."""
        words, places = note.state, self._places
        values = truths(words[2 + self._leaf_words : self._first], len(places))
        then = _by_text(self._texts, self._then(note))
        return TruthValues(origin, self._gap, _instant(words[1]), values, words, places, then)

    def _letter(self, values: Sequence[int], *, passed: bool) -> int:
        """The letter of the run that decided: a pass needs the pessimistic one."""
        alphabet = self.compiled.alphabet
        weights = alphabet.pessimistic if passed else alphabet.optimistic
        return sum(map(getitem, weights, values))

    def details(self, attempt: Attempt, note: Note, name: str) -> dict[str, Any]:
        """The explanatory fields of an attempt, by name; see `Attempt`.

        A forecast takes a search, so it is left for later unless `name` is `forecast`.
        """
        seen: Mapping[str, Any] = {}
        forecast: Callable[[], Verdict | None] | None = None
        if note.kind == _NOTHING:
            why = explain.why_nothing(cut=bool(note.flags & _CUT))
        elif note.kind == _DECIDED:
            why = self._decided(attempt, note)
        else:
            why, forecast = self._open(attempt, note)
        if note.kind == _DECIDED or (note.kind == _OPEN and attempt.decided is not None):
            words = note.state[2 : 2 + self._leaf_words]
            seen = dict(explain.truths_shown(self._texts, truths(words, len(self._texts))))
        fields: dict[str, Any] = {
            "reason": why.reason,
            "deadline": why.deadline,
            "at_trigger": dict(explain.truths_shown(self._texts, self._then(note))),
            "at_decision": seen,
            "required": why.required,
            "blame": why.blame,
        }
        if forecast is None or name == "forecast":
            fields["forecast"] = forecast and forecast()
        else:
            fields["_details"] = lambda *_: {"forecast": forecast()}
        return fields

    def _decided(self, attempt: Attempt, note: Note) -> explain.Explanation:
        flow = self._truth_values(note, attempt.origin)
        passed, when = attempt.verdict is Verdict.PASS, (note.at, attempt.triggered)
        if note.flags & _NETWORK:
            position = note.words[6]
            network = at_decision(
                self.compiled, self._gap, note.letters, position, attempt.triggered, passed, note.at
            )
            return explained_by_network(self.compiled, network, position, passed, *when, flow)
        letter = self._letter(flow.truths, passed=passed)
        token, _ = _token(note.words, _HEAD + self._leaf_words, note.words[3])
        return explained(self._reasons, token, letter, passed, *when, flow)

    def _open(
        self, attempt: Attempt, note: Note
    ) -> tuple[explain.Explanation, Callable[[], Verdict | None] | None]:
        """Why an attempt is open, and a function for its forecast; `None` if it was settled."""
        now = note.at
        judged, token = self._undecided(attempt, note)
        why = explain.why_open(judged, token, now, _instant(note.words[5]))
        if attempt.decision is not Decision.OPEN:
            policy = self.compiled.requirement.at_end
            return why._replace(reason=explain.why_settled(attempt.decision, policy)), None
        return why, partial(explain.forecast_of, judged, token, now)

    def _undecided(self, attempt: Attempt, note: Note) -> tuple[explain.Judged, explain.Undecided]:
        words, flags, at = note.words, note.flags, _HEAD + self._leaf_words
        leaves: Sequence[int] = ()
        if words[4] != NEVER:
            leaves = truths(words[at : at + self._leaf_words], len(self._texts))
            at += self._leaf_words
        runs = self._networks if flags & _NETWORK else self._machines
        judged, worse, better, at = runs(note, at)
        outages = self._outages(words[at:])
        known = {outage.name: outage for outage in outages if outage.until is None}
        doubt = self._doubt(attempt.origin, words[4], leaves, outages)
        names = frozenset().union(*self._reads)
        return judged, explain.Undecided(
            self.compiled, attempt.origin, attempt.triggered, worse, better, doubt,
            explain.unborn_of(names, known, doubt),
            *(bool(flags & f) for f in (_SURE, _CANNOT_PASS, _CUT)),
        )  # fmt: skip

    def _networks(self, note: Note, at: int) -> tuple[explain.Judged, Token, Token, int]:
        """The networks of an open attempt, the tokens of both runs, and the index after them."""
        words = note.words
        position = (words[6],)
        judged = at_moment(
            self.compiled, self._gap, note.letters, words[6], note.at, words[3] >> 32
        )
        worse, better = judged.met((words[at], position), (words[at + 1], position))
        return judged, worse, better, at + 2

    def _machines(self, note: Note, at: int) -> tuple[explain.Judged, Token, Token, int]:
        """The same as `_networks`, for an automaton."""
        words = note.words
        reached, gap = (note.at - 1) // 2, self._gap or 1
        worse, at = _token(words, at, words[3] & 0xFFFFFFFF)
        better, at = _token(words, at, words[3] >> 32)
        return (
            MachineRuns(self.compiled.shaped_residuals, reached // gap * gap, self._gap),
            worse,
            better,
            at,
        )

    def _outages(self, words: Sequence[int]) -> Sequence[explain.Outage]:
        """Decode the outages at the end of a note."""
        spec = self.compiled.spec
        names = (*spec.signals, *spec.events)
        outages = []
        for at in range(1, 1 + 3 * words[0], 3):
            name = names[words[at] & 0xFFFFFFFF]
            why = _WHY[words[at] >> 32]
            until = None if words[at + 2] == _NOT_YET else words[at + 2]
            signal = spec.signals.get(name)
            bound = 0 if signal is None else signal.stale_after or 0
            since = 0 if words[at + 1] == NEVER else words[at + 1]
            outages.append(explain.Outage(name, why, since, until, bound))
        return outages

    def _doubt(
        self, origin: int, position: int, leaves: Sequence[int], outages: Sequence[explain.Outage]
    ) -> explain.Doubt | None:
        """Why the runs of an attempt diverged at `position`; `None` if they have not."""
        if position == NEVER:
            return None
        lost = {
            outage.name: outage
            for outage in outages
            if outage.why in (HealthKind.MISSING, HealthKind.ABSENT) or outage.since <= position
            if outage.until is None or outage.until > position
        }
        unknown: dict[str, explain.Outage] = {}
        texts = []
        for names, text, truth in zip(self._reads, self._texts, leaves, strict=True):
            if truth == UNKNOWN:
                outages_of_text = {name: lost[name] for name in sorted(names & lost.keys())}
                unknown |= outages_of_text
                texts += [] if outages_of_text else [text]
        return explain.Doubt(origin, position, tuple(unknown.values()), tuple(texts))

    @cached_property
    def _reads(self) -> Sequence[frozenset[str]]:
        """The names that each leaf reads."""
        return [
            frozenset() if state.leaf is None else names_of(state.leaf)
            for state, _ in self.compiled.leaves
        ]


def _instant(word: int) -> int | None:
    return None if word == NEVER else word


def _token(words: Sequence[int], at: int, width: int) -> tuple[Token, int]:
    """Decode the token of a run with `width` clocks; returns it with the index after it."""
    end = at + 1 + width
    return (words[at], tuple(words[at + 1 : end])), end


class NotesReader:
    """Explains the attempts of all judges of a plan."""

    def __init__(self, compiled: CompiledSpec, ids: Sequence[str]) -> None:
        self._compiled = compiled
        self._ids = ids

    @cached_property
    def _explainers(self) -> Mapping[str, Sequence[NoteExplainer]]:
        """By requirement, the explainers of its part, by number of the judge."""
        gap = self._compiled.checked.gap
        chosen = self._compiled.chosen(self._ids)
        parts = [[compiled for compiled in chosen if not compiled.requirement.captured]]
        parts += [[compiled] for compiled in chosen if compiled.requirement.captured]
        by_requirement: dict[str, Sequence[NoteExplainer]] = {}
        for part in parts:
            # in the order of the plan
            doubts = (doubt for compiled in part for doubt in (compiled.hidden, compiled.doubted))
            judges = [*part, *filter(None, doubts)]
            explainers = [NoteExplainer(judge, gap) for judge in judges]
            by_requirement |= {compiled.requirement.id: explainers for compiled in part}
        return by_requirement

    def details(self, attempt: Attempt, note: Note, name: str) -> dict[str, Any]:
        """See `NoteExplainer.details`."""
        return self._explainers[attempt.requirement][note.judge].details(attempt, note, name)
