r"""Each rule of outages is needed: without it, filling in what was lost overturns a verdict.

    python -m benchmarks.soundness_rules --runs 100000

For each rule, how many random runs it took to find one whose verdict is wrong without it; exits 1
if there is a rule without which none is found.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, replace
from typing import Any
from unittest import mock

from benchmarks.soundness import try_seed

from rvmon.spec.checked.specification import TimeModel
from rvmon.testing import oracle
from rvmon.testing.generate.spec import Profile
from rvmon.testing.law import past, sample_words, truths
from rvmon.testing.law.kleene import Truth, truth_of
from rvmon.testing.law.outage import Outage
from rvmon.testing.law.word import Letter, SignalState

_SMALL = Profile(requirements=1, depth=2)
_PAST = Profile(
    depth=1,
    requirements=1,
    numbers=False,
    future=False,
    captures=False,
    for_each=False,
    policies=False,
)


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule of the law, and how to drop it.

    Attributes:
        says: the rule.
        owner: whose attribute is another without it.
        name: of the attribute.
        without: what it is then, made of what it is.
        times: the time models in which it matters.
        about: a word of the specifications for which it does.
        profile: of the specifications.
        samples: at most so many; of few, more lies before the first.
    """

    says: str
    owner: Any
    name: str
    without: Callable[[Any], Any]
    times: Sequence[TimeModel] = tuple(TimeModel)
    about: str = ""
    profile: Profile = _SMALL
    samples: int = 12


def _signals(change: Callable[[Any, SignalState], SignalState]) -> Callable[[Any], Any]:
    """Another state of the signals that lost something."""

    def without(law: Callable[..., SignalState]) -> Callable[..., SignalState]:
        def signal(told: Any, declared: Any) -> SignalState:
            state = law(told, declared)
            return change(told, state) if told.has_source and told.outages else state

        return signal

    return without


def _kept(told: Any) -> list[Any]:
    """What was read of a signal, and is not hidden."""
    return [words._update(entry.t, entry.value) for entry in told.entries if not entry.lost]


def _held(told: Any, state: SignalState) -> SignalState:
    kept = _kept(told)
    return replace(state, value=kept[-1].value if kept else None)


def _known_within(told: Any, state: SignalState) -> SignalState:
    return _held(told, state) if told.is_within else state


def _known_behind(told: Any, state: SignalState) -> SignalState:
    return _held(told, state) if state.lost and not told.is_within else state


def _not_updated(_: Any, state: SignalState) -> SignalState:
    return replace(state, updated=Truth.FALSE) if state.updated is Truth.UNKNOWN else state


def _not_changed(told: Any, state: SignalState) -> SignalState:
    return replace(state, changed=Truth.FALSE) if told.is_within else state


def _first_is_no_change(told: Any, state: SignalState) -> SignalState:
    behind = state.changed is Truth.UNKNOWN and not told.is_touched
    return replace(state, changed=Truth.FALSE) if behind else state


def _excused(told: Any, state: SignalState) -> SignalState:
    kept = _kept(told)
    known = [k for k, update in enumerate(kept) if update.value is not None]
    return replace(state, born=bool(known), moved=bool(known) and known[0] < len(kept) - 1)


def _not_moved(told: Any, state: SignalState) -> SignalState:
    return replace(_excused(told, state), born=state.born)


def _looks_across(told: Any, state: SignalState) -> SignalState:
    kept = _kept(told)
    return replace(state, before=kept[-2] if len(kept) > 1 else None)


def _early(law: Callable[..., Any]) -> Callable[..., Any]:
    """An outage stands among what was said at its beginning, and hides nothing that was read."""

    def said_of(name: str, samples: Any, outages: Any, *, has_source: bool) -> Any:
        with mock.patch.object(Outage, "hides", return_value=False):
            told = law(name, samples, outages, has_source=has_source)
        entries = [replace(one, t=one.since) for one in told.entries]
        entries.sort(key=lambda entry: (entry.t, not entry.lost))
        return replace(told, entries=entries)

    return said_of


def _events(falls: Callable[[Any], bool], *, told_only: bool = False) -> Callable[[Any], Any]:
    """Events that are false, or not said to be there, where they may have been lost."""

    def without(law: Callable[..., Any]) -> Callable[..., Any]:
        def event(told: Any, declared: Any) -> Any:
            state = law(told, declared)
            if not told.has_source or not told.is_touched or not falls(told):
                return state
            sure = tuple(one for one in state.occurrences if one.truth is Truth.TRUE)
            updated = Truth.FALSE if state.updated is Truth.UNKNOWN else state.updated
            left = state.occurrences if told_only else sure
            return replace(state, updated=updated, occurrences=left)

        return event

    return without


def _only_samples(law: Callable[..., Sequence[int]]) -> Callable[..., Sequence[int]]:
    def positions(spec: Any, samples: Any, outages: Any, first: int, end: int) -> Sequence[int]:
        if spec.time is TimeModel.SAMPLED:
            outages = ()
        elif samples:
            first = samples[0].t
        return law(spec, samples, outages, first, end)

    return positions


def _regardless(method: str) -> Callable[[Any], Any]:
    """Truth where there may be no position, as if there were one of which nothing is known."""

    def without(law: Callable[..., Truth]) -> Callable[..., Truth]:
        def truth(self: Any, formula: Any, i: int, **rest: Any) -> Truth:
            if self._letters[i].sure:
                return law(self, formula, i, **rest)
            return (
                self._truth(formula, i, rest.get("positive", True))
                if method == "truth"
                else (self._state(formula, i))
            )

        return truth

    return without


def _first_read(_: Any) -> Callable[..., Truth]:
    def is_first(self: Any, i: int) -> Truth:
        return truth_of(not any(letter.sure for letter in self._letters[:i]))

    return is_first


def _since_read(_: Any) -> Callable[..., Truth]:
    def lasted(letters: Sequence[Letter], i: int, duration: int) -> Truth:
        read = (letter.instant for letter in letters[: i + 1] if letter.sure)
        return truth_of(any(letters[i].instant - t >= duration for t in read))

    return lasted


def _since_lost(_: Any) -> Callable[..., Truth]:
    def lasted(letters: Sequence[Letter], i: int, duration: int) -> Truth:
        return truth_of(letters[i].instant - letters[0].instant >= duration)

    return lasted


def _ends_when_read(law: Callable[..., Any]) -> Callable[..., Any]:
    def word(spec: Any, samples: Any, *, outages: Sequence[Outage], **told: Any) -> Any:
        last = max((sample.t for sample in samples), default=0)
        end = max([last, *(t for t in (told["end"],) if t is not None)])
        cut = (replace(o, last=min(o.last, end)) for o in outages if o.first <= end)
        return law(spec, samples, outages=tuple(cut), **told)

    return word


words: Any = sample_words
_FILLED = (TimeModel.HELD, TimeModel.CLOCKED)
_CLOCKED = (TimeModel.CLOCKED,)
_SAMPLED = (TimeModel.SAMPLED,)

RULES = (
    Rule("within, a signal is unknown", words, "_signal", _signals(_known_within), _FILLED),
    Rule("behind, it is until an update", words, "_signal", _signals(_known_behind)),
    Rule("what is kept within may be followed", words, "_said_of", _early),
    Rule(
        "so may what is kept in an outage of one instant",
        *(Outage, "hides"),
        lambda _: lambda self, instant: self.first <= instant < self.last,
    ),
    Rule("`updated` is unknown", words, "_signal", _signals(_not_updated), _FILLED, "updated("),
    Rule("`changed` is unknown", words, "_signal", _signals(_not_changed), _FILLED, "changed("),
    Rule(
        "the first update behind may be no change",
        *(words, "_signal"),
        _signals(_first_is_no_change),
        about="changed(",
    ),
    Rule(
        "`known` is unknown",
        *(words, "_signal"),
        _signals(lambda _, state: replace(state, lost=False)),
        about="known(",
    ),
    Rule("what was lost is born", words, "_signal", _signals(_excused)),
    Rule(
        "or is not: it shows no birth to `since`",
        *(truths, "since"),
        lambda law: lambda *told, **_: law(*told),
        about="since",
        profile=_PAST,
    ),
    Rule("and has a value before", words, "_signal", _signals(_not_moved), about="(x)"),
    Rule(
        "`prev`, `delta`, `rate` do not look across",
        *(words, "_signal"),
        _signals(_looks_across),
        about="(x)",
    ),
    Rule(
        "within, an event is unknown",
        *(words, "_event"),
        _events(lambda told: told.is_within),
        _FILLED,
    ),
    Rule(
        "so is `updated` of an event",
        *(words, "_event"),
        _events(lambda told: told.is_within, told_only=True),
        _FILLED,
        "updated(",
    ),
    Rule(
        "an event lost counts at the first tick at or behind it",
        *(words, "_event"),
        _events(lambda told: not told.is_within),
        _CLOCKED,
    ),
    Rule(
        "an update lost counts at the first tick at or behind it",
        *(words, "_if_lost"),
        lambda _: lambda *__: Truth.FALSE,
        _CLOCKED,
        "ed(",
    ),
    Rule("the trace may begin in an outage", words, "_positions", _only_samples, _FILLED),
    Rule("a position may lie at any tick", words, "_positions", _only_samples, _SAMPLED),
    Rule("or at none", words, "_is_sure", lambda _: lambda *__: True, _SAMPLED),
    Rule("there every formula is unknown", truths.Truths, "truth", _regardless("truth"), _SAMPLED),
    Rule(
        "of the past, too",
        *(truths.Truths, "state"),
        _regardless("state"),
        _SAMPLED,
        profile=_PAST,
    ),
    Rule("`start` may have been there", truths.Truths, "_is_first", _first_read, about="start"),
    Rule("`held` may be long enough", past, "_lasted", _since_read, about="held("),
    Rule(
        "`held` may not be long enough", past, "_lasted", _since_lost, _SAMPLED, "held(", _PAST, 3
    ),
    Rule("the trace reaches to the end of an outage", oracle, "word_of", _ends_when_read),
)


def runs_needed(rule: Rule, seeds: Iterator[str], fillings: int = 8) -> int | None:
    """How many runs it takes to find an overturned one without a rule; `None`: more than given."""
    with ExitStack() as stack:
        law = getattr(rule.owner, rule.name)
        stack.enter_context(mock.patch.object(rule.owner, rule.name, rule.without(law)))
        for number, seed in enumerate(seeds, start=1):
            time = rule.times[number % len(rule.times)]
            profile = replace(rule.profile, time=time)
            alone = number % 2 == 1
            tried = try_seed(
                seed,
                fillings,
                profile,
                outages=True,
                alone=alone,
                about=rule.about,
                samples=rule.samples,
            )
            if tried is not None and tried[1].overturning is not None:
                return number
    return None


def main(argv: list[str]) -> int:
    """Drop one rule after the other."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--runs", type=int, default=100_000, help="at most so many for each rule")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--rule", help="only those that say so")
    options = parser.parse_args(argv)
    unneeded = 0
    for rule in RULES:
        if options.rule and options.rule not in rule.says:
            continue
        needed = runs_needed(rule, (f"{options.seed}/{k}" for k in range(options.runs)))
        unneeded += needed is None
        found = "none found" if needed is None else f"found in run {needed}"
        print(f"{rule.says:<64} {found}", flush=True)
    return 1 if unneeded else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
