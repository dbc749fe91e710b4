"""The record of an attempt: fields computed late are the same for every reader."""

import copy
import pickle

import pytest

from rvmon.verdicts import Verdict
from rvmon.verdicts.attempt import Attempt, Decision

REST = {
    "reason": "too late",
    "deadline": 7,
    "at_trigger": {"a": True},
    "at_decision": {"a": False},
    "required": "F a",
    "captured": {},
    "blame": None,
    "forecast": None,
    "robustness": None,
}


def decided(calls: list[object] | None = None) -> Attempt:
    """A record whose other fields are computed on access; the calls are recorded."""

    def details(attempt: Attempt, noted: object, name: str) -> dict[str, object]:
        if calls is not None:
            calls.append((attempt.number, noted, name))
        return REST

    made = Attempt.__new__(Attempt)
    made.requirement, made.number, made.triggered, made.decided = "R1", 3, 0, 5
    made.verdict, made.decision, made.in_doubt = Verdict.FAIL, Decision.PREFIX, False
    made._details, made._noted = details, "noted"
    return made


def test_other_fields_are_computed_once_on_access():
    """Verdict and instants need no computation; access to another field computes all of them."""
    calls: list[object] = []
    attempt = decided(calls)
    assert (attempt.name, attempt.verdict, attempt.decided, attempt.in_doubt) == (
        *("R1#3", Verdict.FAIL, 5),
        False,
    )
    assert calls == []
    assert (attempt.reason, attempt.deadline, attempt.required) == ("too late", 7, "F a")
    assert calls == [(3, "noted", "reason")]
    assert attempt == Attempt("R1", 3, 0, 5, Verdict.FAIL, **REST)


@pytest.mark.parametrize("copied", [copy.copy, lambda it: pickle.loads(pickle.dumps(it))])  # noqa: S301 - just made
def test_a_copy_has_all_fields(copied):
    """A record sent to another process has its fields, without the code that computes them."""
    assert copied(decided()) == decided()


def test_an_unknown_field_is_an_attribute_error():
    with pytest.raises(AttributeError, match="reeson"):
        decided().reeson  # noqa: B018
