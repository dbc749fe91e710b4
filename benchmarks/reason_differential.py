r"""What records say beside the verdict: the core against the engine `auto`.

    python -m benchmarks.reason_differential --pairs 600 --seed 1
    python -m benchmarks.reason_differential --specs specs/handover.rv examples/base.rv

All fields of decided and open attempts are compared, on random specs in each model of time, at each
action of a trace and at its end. A difference that one of the rules below allows is counted by it,
all others are shown; exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

from tests.tools.drive import feed

import rvmon
from rvmon.errors import RvmonError
from rvmon.monitor import build_monitor
from rvmon.monitor.compiled.refusal import of_tables
from rvmon.monitor.core.notes import Note, note_at, note_of
from rvmon.session import Spec
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.case import Case
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace
from rvmon.testing.show import show_case
from rvmon.verdict.attempt import Attempt

FIELDS = [one.name for one in fields(Attempt)]
_NETWORK = 1
_SINCE = re.compile(r" \(since [^)]*\)|it had .*|(was|became) |^left open by the input: ")


@dataclass(frozen=True, slots=True)
class Pair:
    """One attempt as both engines tell of it.

    Attributes:
        spec: the specification.
        want: of `auto`.
        got: of the core.
        note: what that noted.
    """

    spec: Spec
    want: Attempt
    got: Attempt
    note: Note

    @property
    def differing(self) -> list[str]:
        """The fields that differ."""
        return [name for name in FIELDS if getattr(self.want, name) != getattr(self.got, name)]

    @property
    def is_other_kind(self) -> bool:
        """Whether a network judges it in one engine, and an automaton in the other.

        `auto` judges attempts in doubt by networks; it generates no large tables.
        """
        compiled = self.spec._compiled.requirements[self.want.requirement]
        requirement = compiled.requirement
        apart = bool(requirement.captures) or requirement.for_each is not None
        if self.note.judge and self.want.in_doubt and (compiled.hidden or compiled.doubted):
            networked = True
        elif apart:
            networked = compiled.engine("auto") == "network"
        else:
            tabled = compiled.automaton is not None and of_tables(compiled) is None
            networked = compiled.follows_windows or not tabled
        return networked is not bool(self.note.flags & _NETWORK)

    @property
    def is_merged(self) -> bool:
        """Whether the automaton of `auto` has merged locations that the core tells apart."""
        compiled = self.spec._compiled.requirements[self.want.requirement]
        own, other = compiled.shaped, compiled.automaton
        if own is None or other is None or self.note.flags & _NETWORK:
            return False
        return len(own.locations) > len(other.locations)

    @property
    def is_apart(self) -> bool:
        """Whether its requirement has values of its own."""
        requirement = self.spec.requirements[self.want.requirement]
        return bool(requirement.captures) or requirement.for_each is not None


def _words_differently(pair: Pair) -> bool:
    """What is owed is worded from a network here, from an automaton there: both are right."""
    allowed = {"reason", "owed", "deadline", "forecast", "blame"}
    if pair.is_apart:  # and names the leaves of the trigger; see below
        allowed |= {"at_trigger", "at_decision"}
    return pair.is_other_kind and allowed.issuperset(pair.differing)


def _looks_back_farther(pair: Pair) -> bool:
    """Since when a proposition is so the core knows from before the attempt with its values, too.

    It names the leaves of the trigger as well. `auto` began to look where the attempt did.
    """
    if not pair.is_apart:
        return False
    want, got = (
        (
            set(_SINCE.sub("", pair.want.reason).split("; "))
            - set(_SINCE.sub("", one.reason).split("; ")),
            one.blame and replace(one.blame, at=()),
            {text: one.at_trigger.get(text) for text in pair.want.at_trigger},
            {text: one.at_decision.get(text) for text in pair.want.at_decision},
        )
        for one in (pair.want, pair.got)
    )
    allowed = {"reason", "blame", "at_trigger", "at_decision"}
    return allowed.issuperset(pair.differing) and want == got


def _begins_elsewhere(pair: Pair) -> bool:
    """Of locations that are merged one speaks for all: what decided may have begun elsewhere."""
    return pair.is_merged and {"reason", "blame"}.issuperset(pair.differing)


def _hears_ahead(pair: Pair) -> bool:
    """Between two ticks `auto` has heard of the next value, and says no more why there was none."""
    clocked = pair.spec.checked.gap not in (None, 1)
    return clocked and pair.differing == ["reason"] and " was not known at " in pair.want.reason


RULES: Mapping[str, Callable[[Pair], bool]] = {
    "judged by a network here, by an automaton there": _words_differently,
    "looks back behind the begin of what has values of its own": _looks_back_farther,
    "locations that were merged": _begins_elsewhere,
    "a value between two ticks": _hears_ahead,
}


def _key(attempt: Attempt) -> tuple[str, bool, int]:
    return attempt.requirement, attempt.in_doubt, attempt.number


def pairs(spec: Spec, case: Case) -> Iterator[Pair]:
    """All attempts that both engines tell of in a case, at each action and at the end.

    Raises:
        AssertionError: they tell of different ones.
    """
    core, auto = (
        build_monitor(spec._compiled, engine=one, sources=case.names) for one in ("c", "auto")
    )
    for action in case.actions:
        told = ([*feed(auto, action), *auto.open], [*feed(core, action), *core.open])
        yield from _matched(spec, *told, lambda one: note_of(*one._noted[1:]))
    want, got = auto.finish_ns(case.end), core.finish_ns(case.end)
    attempts: Any = got.attempts
    yield from _matched(
        spec,
        want.attempts,
        attempts,
        lambda one: note_at(attempts._notes[0], one._noted[1], attempts._notes[1]),
    )


def _matched(
    spec: Spec,
    wanted: Iterable[Attempt],
    told: Iterable[Attempt],
    noted: Callable[[Attempt], Note],
) -> Iterator[Pair]:
    want, got = ({_key(one): one for one in some} for some in (wanted, told))
    if want.keys() != got.keys():
        raise AssertionError(f"there are other attempts: {want.keys() ^ got.keys()}")
    for key, one in want.items():
        note = noted(got[key])  # which is gone once it is read
        yield Pair(spec, one, got[key], note)


def compare(spec: Spec, case: Case, tally: Counter[str]) -> list[str]:
    """Compare all attempts of a case; returns what no rule allows, as text."""
    shown = []
    for pair in pairs(spec, case):
        tally[f"attempts {pair.want.decision.value} {pair.want.verdict.value}"] += 1
        found = pair.differing
        if not found:
            continue
        rule = next((name for name, allows in RULES.items() if allows(pair)), None)
        tally[f"differ: {rule}"] += 1
        if rule is None:
            lines = [
                f"{name}\n  auto: {getattr(pair.want, name)}\n  core: {getattr(pair.got, name)}"
                for name in found
            ]
            shown.append("\n".join([pair.want.name, *lines, show_case(case)]))
    return shown


def cases(options: argparse.Namespace) -> Iterator[tuple[Spec, Case]]:
    """The specifications and traces that are asked for."""
    for number, path in enumerate(options.specs):
        spec = rvmon.load(path)
        rng = random.Random(f"reasons/{options.seed}/{path}/{number}")
        for _ in range(options.traces):
            yield spec, random_trace(rng, spec.checked, TraceProfile(unknowns=not options.known))
    if options.specs:
        return
    models = list(TimeModel)
    for number in range(options.pairs // options.traces):
        rng = random.Random(f"reasons/{options.seed}/{number}")
        checked = random_spec(rng, Profile(time=models[number % len(models)]))
        spec = Spec(checked)
        for _ in range(options.traces):
            yield spec, random_trace(rng, checked, TraceProfile(unknowns=not options.known))


def main(argv: Sequence[str]) -> int:
    """Run the campaign and print its figures."""
    parser = argparse.ArgumentParser(description="Reasons of the core against those of `auto`.")
    parser.add_argument("--pairs", type=int, default=300)
    parser.add_argument("--traces", type=int, default=3, help="of the pairs with one spec")
    parser.add_argument("--seed", default="1")
    parser.add_argument("--known", action="store_true", help="nothing is unknown")
    parser.add_argument("--specs", nargs="*", default=[], help="files, instead of random specs")
    options = parser.parse_args(argv)
    tally: Counter[str] = Counter()
    wrong: list[str] = []
    for spec, case in cases(options):
        try:
            wrong += compare(spec, case, tally)
        except RvmonError as error:
            tally[f"refused: {error}"[:70]] += 1
    print(*wrong[:5], sep="\n\n", end="\n\n" if wrong else "")
    for what, count in sorted(tally.items()):
        print(f"{count:8,} {what}")
    return int(bool(wrong))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
