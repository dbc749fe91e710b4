"""The native search: large numbers, damaged plans, lack of memory, and interruption."""

import base64
import zlib
from array import array
from dataclasses import replace
from pathlib import Path
from random import Random
from threading import Thread

import pytest
from tests.rvmon.models.search.plans import search_plans
from tests.tools.timed_generate import random_model

from rvmon.models.language.load import load_network, loads_network
from rvmon.models.network import LeadsToFormula
from rvmon.models.network.derived import finer
from rvmon.models.network.expressions import (
    BinaryOperation,
    ClockCompare,
    Constant,
    PathFormula,
    UnaryOperation,
)
from rvmon.models.search.native_search import search
from rvmon.models.search.verify import verify

MODELS = Path(__file__).parents[4] / "examples" / "models"
ENDED, FOUND, STOPPED, FAILED, NO_MEMORY, TOO_LARGE = range(1, 7)


def in_units(formula, factor):
    """A formula with all its times multiplied by a factor."""
    match formula:
        case LeadsToFormula(left, right, bound) | BinaryOperation(_, left, right, bound):
            changed = {"left": in_units(left, factor), "right": in_units(right, factor)}
            if isinstance(formula, LeadsToFormula) and bound is not None:
                changed["bound"] = bound * factor
            return replace(formula, **changed)
        case PathFormula(_, body, bound):
            bound = None if bound is None else bound * factor
            return replace(formula, body=in_units(body, factor), bound=bound)
        case UnaryOperation(_, operand):
            return replace(formula, operand=in_units(operand, factor))
        case ClockCompare(_, _, Constant(value)):
            return replace(formula, bound=Constant(value * factor))
        case _:
            return formula


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1 << 12, 1 << 29])
def test_large_numbers_change_no_answer(factor):
    for seed in range(12):
        network = loads_network(random_model(seed))
        large = finer(network, factor)
        for query in network.queries:
            one = verify(network, query)
            other = verify(large, replace(query, formula=in_units(query.formula, factor)))
            assert (one.holds, one.statistics.visited, one.statistics.stored) == (
                other.holds,
                other.statistics.visited,
                other.statistics.stored,
            ), (seed, query.text)


def asked(plan, numbers=None, most_bytes=-1, most_states=-1):
    """The state in which the native search ends if every loop is accepted."""
    numbers = plan.numbers if numbers is None else numbers
    found = search(
        numbers, plan.costs, lambda *_: True, lambda *_: True, most_states, most_bytes, False
    )
    return found[0]


@pytest.mark.slow
def test_a_damaged_plan_is_refused_or_searched_without_a_crash():
    random, states = Random(5), set()
    for plan in search_plans(range(12)):
        for _ in range(20):
            numbers = array("i", plan.numbers)
            at = random.randrange(len(numbers))
            numbers[at] = random.choice(
                (-1, 0, 1, 2, 7, numbers[at] + 1, numbers[at] - 1, (1 << 31) - 1, -(1 << 31))
            )
            try:
                states.add(asked(plan, numbers.tobytes(), 1 << 26, 2000))
            except (ValueError, OverflowError):
                states.add("refused")
    assert {"refused", ENDED, FOUND} <= states


@pytest.mark.parametrize("numbers", [b"", b"\x00" * 4, b"\x31\x30\x4e\x5a", b"\x00" * 400])
def test_bytes_that_are_no_plan_are_refused(numbers):
    with pytest.raises(ValueError, match="damaged"):
        search(numbers, b"", lambda *_: True, lambda *_: True, -1, -1, False)


@pytest.mark.slow
def test_memory_may_run_out_at_any_point():
    random, without = Random(6), 0
    for plan in search_plans(range(12)):
        answer = asked(plan)
        for _ in range(25):
            given = asked(plan, most_bytes=int(2 ** random.uniform(4, 18)))
            assert given in (answer, NO_MEMORY)
            without += given == NO_MEMORY
    assert without > 500


FAILS_IN_ITS_SECOND_STATE = zlib.decompress(
    base64.b85decode(
        "c-nnZK?(vf3`~=vf*>f~1aDqEso*p80p5Iq4-miMGd%e{O>inhECz-&nRK!pcDp&A2J#6*F7g{|hdOrP"
        "_n1GRe|A*I1^Mb&IPSRrFUS4|be`zvEZ{jx%0}GFqxX)I_(IyO7knkI@vJ#cdJ%bF+?$Zb9J4%QK<g`g"
        "gMw4yjd-qaUyqie)X&}wlNU;LVCEQgeBrq`Pm|87<B=p!c~8`qJgoHY##`bA{}}sN;BC`-1Ir#xp8"
    )
)
"""A plan found by a fuzzer: its search mistook lack of memory for a failure of the model."""


def test_lack_of_memory_is_not_a_failure_of_the_model():
    told = set()
    for most_bytes in range(0, 20_000, 8):
        state, *_, visited = search(
            FAILS_IN_ITS_SECOND_STATE,
            bytes(16),
            lambda *_: True,
            lambda *_: True,
            -1,
            most_bytes,
            False,
        )[:5]
        told.add((state, visited if state == FAILED else 0))
    assert told == {(FAILED, 2), (NO_MEMORY, 0)}


def test_a_query_is_undecided_if_memory_runs_out(monkeypatch):
    def poor(*arguments):
        return search(*arguments[:5], 20_000, arguments[6])

    monkeypatch.setattr("rvmon.models.search.native_search.search", poor)
    network = load_network(MODELS / "train_gate.ta", constants={"N": 4})
    outcome = verify(network, network.queries[0])
    assert (outcome.holds, outcome.remark) == (None, "not decided: memory ran out")


def test_an_exception_of_the_watcher_stops_the_search():
    def watch(progress):
        raise KeyboardInterrupt

    network = load_network(MODELS / "train_gate.ta", constants={"N": 6})
    with pytest.raises(KeyboardInterrupt):
        verify(network, network.queries[0], watch=watch)


def test_other_threads_run_during_a_search():
    heard = []
    thread = Thread(target=heard.append, args=(1,))

    def watch(progress):
        if not thread.is_alive() and not heard:
            thread.start()
        if heard:
            raise StopIteration

    network = load_network(MODELS / "train_gate.ta", constants={"N": 6})
    with pytest.raises(StopIteration):
        verify(network, network.queries[0], watch=watch)
