"""Ours against MONA, through ltlf2dfa, on LTL over finite traces.

    python -m benchmarks.cross_mona --formulas 1000 --words 20 [--against oracle monitor]

LTL on a finite trace knows its end, a monitor does not. So the end is made visible: every word
gets one more position where `alive` is false, and the formula speaks of positions with `alive`.
Then every verdict is decided by the trace and is compared with the acceptance of MONA's minimal
automaton. The plain formula on the plain word is judged, too: what the trace decides, and what is
held to its end, has to agree. Prints the counts and every disagreement; exits 1 if there is one.
Needs `mona` on the path.
"""

from __future__ import annotations

import argparse
import random
import shutil
import sys
import time
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from benchmarks.peers.client import Peer, PeerError
from benchmarks.peers.dialects import LTLF, spelling, translate
from benchmarks.peers.environment import prepare
from benchmarks.peers.positions import Judge, ask_monitor, ask_oracle
from tests.tools.common_fragment import EVER, both, to_core
from tests.tools.generate_ltl import random_ltl

from rvmon.spec.checked.formula import (
    Binary,
    BinaryOp,
    Bound,
    BoundAtom,
    Formula,
    SignalAtom,
    Unary,
    UnaryOp,
)
from rvmon.spec.checked.specification import CheckedSpec, Mode, Requirement, Signal, TimeModel, Type
from rvmon.spec.print.printer import format_formula
from rvmon.testing.generate.rng import Rng, chance
from rvmon.testing.generate.vocabulary import BOOLS
from rvmon.trace.sample import Sample
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt import Decision
from rvmon.verdict.verdict import Verdict

LTLF2DFA = Path(__file__).parent / "peers" / "with_ltlf2dfa.py"
JUDGES: dict[str, Judge] = {"oracle": ask_oracle, "monitor": ask_monitor}
ALIVE = SignalAtom("alive")
Word = list[frozenset[str]]


def no(operand: Formula) -> Formula:
    """`not operand`."""
    return Unary(UnaryOp.NOT, operand)


def until(left: Formula, right: Formula) -> Formula:
    """`left until right`, however long that takes."""
    return Binary(BinaryOp.UNTIL, left, right, EVER)


def embed(core: Formula) -> Formula:
    """A formula of the core that is at the end of `alive` what `core` is at the end of the trace.

    Source: De Giacomo and Vardi, Linear temporal logic and linear dynamic logic on finite traces,
    IJCAI 2013, section 2.
    """
    match core:
        case Unary(op=UnaryOp.NOT, operand=operand):
            return no(embed(operand))
        case Unary(op=UnaryOp.NEXT, operand=operand):
            return Unary(UnaryOp.NEXT, both(ALIVE, embed(operand)))
        case Unary(op=UnaryOp.EVENTUALLY, operand=operand):
            return until(ALIVE, both(ALIVE, embed(operand)))
        case Unary(op=UnaryOp.ALWAYS, operand=operand):
            return no(until(ALIVE, both(ALIVE, no(embed(operand)))))
        case Binary(op=BinaryOp.UNTIL, left=left, right=right):
            return until(both(ALIVE, embed(left)), both(ALIVE, embed(right)))
        case Binary(op=op, left=left, right=right):
            return Binary(op, embed(left), embed(right))
        case _:
            return core


def judged(judge: Judge, formula: Formula, word: Word, *, mark_end: bool) -> bool | None:
    """Our verdict of a formula at the first position of a word; `None` if it stays open."""
    names = (*BOOLS, ALIVE.name)
    signals = {name: Signal(name, Type(Kind.BOOL)) for name in names}
    requirement = Requirement("R", Mode.UPON, BoundAtom(Bound.START), formula)
    spec = CheckedSpec("ltl", "", TimeModel.SAMPLED, signals, {}, {"R": requirement})
    letters = [letter | {ALIVE.name} for letter in word]
    if mark_end:
        letters.append(frozenset())
    samples = [
        Sample(t, {name: name in letter for name in names}) for t, letter in enumerate(letters)
    ]
    (attempt,) = judge(spec, samples, len(letters)).attempts
    if attempt.verdict is Verdict.INCONCLUSIVE:
        return None
    assert attempt.decision in (Decision.PREFIX, Decision.HELD_TO_END)  # noqa: S101 - no policies
    return attempt.verdict is Verdict.PASS


def compare(
    number: int, seed: int, count: int, peer: Peer, judges: dict[str, Judge], tally: Counter[str]
) -> list[str]:
    """Compare one random formula on so many random words; the disagreements as text."""
    rng = random.Random(f"{seed}/{number}")
    formula = random_ltl(rng, rng.randint(1, 4))
    words = [_word(rng) for _ in range(count)]
    core = to_core(formula)
    try:
        answer = peer.ask(
            "accepts",
            formula=translate(formula, LTLF),
            words=[[sorted(map(spelling, letter)) for letter in word] for word in words],
        )
    except PeerError as error:
        tally[f"no answer: {error}"[:80]] += 1
        return []
    tally["formulas"] += 1
    tally["states"] = max(tally["states"], answer["states"])
    found = []
    for name, judge in judges.items():
        for word, accepted in zip(words, answer["accepted"], strict=True):
            marked = judged(judge, embed(core), word, mark_end=True)
            plain = judged(judge, formula, word, mark_end=False)
            tally[f"{name}: words {'accepted' if accepted else 'rejected'}"] += 1
            tally[f"{name}: decided without the mark"] += plain is not None
            if marked is not accepted or plain not in (None, accepted):
                letters = " ".join("".join(sorted(letter)) or "-" for letter in word)
                found.append(
                    f"formula {number}, {name}: {format_formula(formula)} on {letters}: "
                    f"MONA {accepted}, marked {marked}, plain {plain}"
                )
    return found


def _word(rng: Rng) -> Word:
    length = rng.randint(1, 8)
    return [frozenset(name for name in BOOLS if chance(rng, 50)) for _ in range(length)]


def parse(argv: Sequence[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description="Ours against MONA on LTL over finite traces.")
    parser.add_argument("--formulas", type=int, default=200)
    parser.add_argument("--words", type=int, default=20)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--against", nargs="*", choices=list(JUDGES), default=["oracle"])
    return parser.parse_args(argv)


def main(argv: Sequence[str]) -> int:
    """Run the campaign and print its figures."""
    options = parse(argv)
    environment = prepare()
    if shutil.which("mona") is None or "ltlf2dfa" in environment.missing:
        print("not run: `mona` or ltlf2dfa is missing (apt-get install mona)")
        return 2
    began = time.perf_counter()
    tally: Counter[str] = Counter()
    found: list[str] = []
    judges = {name: JUDGES[name] for name in options.against}
    with Peer(environment.python, LTLF2DFA) as peer:
        for number in range(options.formulas):
            found += compare(number, options.seed, options.words, peer, judges, tally)
    seconds = time.perf_counter() - began
    print(f"ltlf2dfa {environment.versions['ltlf2dfa']}, seed {options.seed}, {seconds:.0f} s")
    for name, figure in tally.items():
        print(f"  {name} {figure}")
    print(f"  disagreements {len(found)}")
    for text in found[:10]:
        print(text)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
