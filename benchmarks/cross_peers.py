"""Ours against the peers on random formulas and traces, at every tick.

    python -m benchmarks.cross_peers --pairs 10000 [--only rtamt-dense …] [--against monitor …]

A peer's verdict is compared wherever it has one and ours is decided by the trace. Prints for each
peer how much was compared and every disagreement, shrunk; exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial

from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.contest import CONTESTS, Contest, ask_peer, random_question, shrink
from benchmarks.peers.dialects import translate
from benchmarks.peers.environment import prepare
from benchmarks.peers.positions import Judge, Question, answers, ask_monitor, ask_oracle

from rvmon.errors import RvmonError
from rvmon.spec.print.printer import format_formula

JUDGES: dict[str, Judge] = {"oracle": ask_oracle, "monitor": ask_monitor}


@dataclass(slots=True)
class Tally:
    """What a campaign against one peer found."""

    pairs: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    ticks: Counter[str] = field(default_factory=Counter)
    errors: Counter[str] = field(default_factory=Counter)
    disagreements: list[str] = field(default_factory=list)


def campaign(
    contest: Contest, peer: Peer, judges: dict[str, Judge], pairs: int, seed: int
) -> Tally:
    """Compare on so many pairs of a formula and a trace."""
    tally = Tally()
    for number, question in zip(range(pairs), _questions(contest, tally, seed), strict=False):
        try:
            theirs = ask_peer(contest, peer, question)
        except PeerError as error:
            tally.errors[str(error)[:100]] += 1
            continue
        tally.pairs += 1
        for name, judge in judges.items():
            try:
                ours = answers(question, judge)
            except RvmonError as error:
                tally.errors[f"{name} declines: {error}"[:100]] += 1
                continue
            for own, other in zip(ours, theirs, strict=True):
                tally.ticks[f"{_word(own)} / {_word(other)}"] += 1
            if _disagree(ours, theirs):
                small = shrink(question, partial(_differs, contest, peer, judge))
                shown = _show(contest, small, answers(small, judge), ask_peer(contest, peer, small))
                tally.disagreements.append(f"pair {number}, {name}\n{shown}")
    return tally


def _questions(contest: Contest, tally: Tally, seed: int) -> Iterator[Question]:
    number = 0
    while True:
        rng = random.Random(f"{seed}/{contest.way.name}/{number}")
        number += 1
        question, reason = random_question(rng, contest)
        if question is None:
            tally.refused[reason] += 1
        else:
            yield question


def _differs(contest: Contest, peer: Peer, judge: Judge, question: Question) -> bool:
    try:
        return _disagree(answers(question, judge), ask_peer(contest, peer, question))
    except (PeerError, RvmonError, ValueError):
        return False


def _disagree(ours: list[bool | None], theirs: list[bool | None]) -> bool:
    return any(
        own is not None and other is not None and own is not other
        for own, other in zip(ours, theirs, strict=True)
    )


def _word(value: bool | None) -> str:
    return {True: "true", False: "false", None: "open"}[value]


def _show(
    contest: Contest, question: Question, ours: list[bool | None], theirs: list[bool | None]
) -> str:
    width = max(6, *(len(name) for name in question.columns))
    asked = translate(question.formula, contest.way.dialect)
    lines = [f"{format_formula(question.formula)}   as   {asked}"]
    rows = {**question.columns, "ours": ours, "theirs": theirs}
    for name, column in rows.items():
        cells = ["." if value is None else f"{value:g}" for value in column]
        lines.append(f"  {name:{width}} " + " ".join(cells))
    return "\n".join(lines)


def parse(argv: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description="Ours against the peers, tick for tick.")
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", choices=list(CONTESTS), default=list(CONTESTS))
    parser.add_argument("--against", nargs="*", choices=list(JUDGES), default=["oracle"])
    parser.add_argument("--show", type=int, default=5, help="disagreements printed at most")
    return parser.parse_args(argv)


def main(argv: list[str]) -> int:
    """Run the campaigns and print their figures."""
    options = parse(argv)
    environment = prepare()
    judges = {name: JUDGES[name] for name in options.against}
    failed = False
    for name in options.only:
        contest = CONTESTS[name]
        if contest.way.package in environment.missing:
            reason = environment.missing[contest.way.package]
            print(f"{name}: {contest.way.package} is missing: {reason}")
            continue
        began = time.perf_counter()
        with Peer(environment.python, contest.way.worker) as peer:
            tally = campaign(contest, peer, judges, options.pairs, options.seed)
        version = environment.versions[contest.way.package]
        seconds = time.perf_counter() - began
        print(f"{name} ({contest.way.package} {version}), seed {options.seed}, {seconds:.0f} s")
        print(f"  pairs {tally.pairs}, refused {sum(tally.refused.values())}")
        print("  ticks ours / theirs:", ", ".join(f"{k} {n}" for k, n in tally.ticks.most_common()))
        for text, count in tally.errors.most_common(5):
            print(f"  no answer, {count} times: {text}")
        print(f"  disagreements {len(tally.disagreements)}")
        for text in tally.disagreements[: options.show]:
            print("\n" + text)
        failed = failed or bool(tally.disagreements)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
