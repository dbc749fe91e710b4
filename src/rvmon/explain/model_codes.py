"""The codes of findings about models and queries, a paragraph each."""

from __future__ import annotations

from collections.abc import Mapping

from rvmon.timed.model.rules import RULES

_ABOUT = {
    "TA001": "The text is no model or query: what was found and what could have stood there.",
    "TA002": "A name is used that is declared nowhere it can be seen from. A location of an "
    "automaton is written `Automaton.location` in queries.",
    "TA003": "Two things of one scope have the same name: rename one.",
    "TA004": "A name stands for something else than what is wanted there: a clock for a number, "
    "an array without index, a variable that is set though it is constant.",
    "TA005": "An int needs a range, `int[0,5] n`, so that there are finitely many states; "
    "a range of more than 65,536 values gets a warning: there may be too many.",
    "TA006": "Bounds, sizes and values of constants are worked out before the search: only numbers "
    "and constants can stand there.",
    "TA007": "A value lies outside what it is for: an index beyond an array, a clock set to a "
    "negative number, a number beyond what is computed with.",
    "TA008": "Clocks are compared with numbers, not with each other: differences and sums of "
    "clocks make zones that are not extrapolated safely.",
    "TA009": "A clock stands where time cannot decide: under `or` or `not`, or bounded from below "
    "in an invariant. Invariants are upper bounds; a lower bound is a guard of the edge.",
    "TA010": "A channel has senders without receivers, or the other way round: its edges are "
    "never taken.",
    "TA011": "An edge on an urgent channel may not wait for a clock: time stops while it could be "
    "taken.",
    "TA012": "A receiver of a broadcast may not have a guard on a clock: put it on the sender, or "
    "on an edge behind.",
    "TA013": "An automaton needs a location to begin in: `start name`.",
    "TA014": "The invariants of the locations to begin in do not hold together at time 0.",
    "TA015": "A template is given too many or too few values, or such as its parameters do not "
    "take.",
    "TA016": "The language of UPPAAL has this, and it is not supported here; what is said instead "
    "stands beside the finding.",
    "TA017": "The weight of an edge, by which random runs choose, is no number above 0.",
    "TA018": "The file is no XML, or not that of a model.",
    "TA019": "The model is larger, or nested more deeply, than what is read; or it has more edges "
    "or values than can be searched.",
    "TA020": "This query is not decided: statistics, games, `sup`, `inf`, until; or there is none.",
    "TA021": "The model has no automaton: there is nothing to search.",
    "TA022": "The file cannot be read.",
    "TA023": "To hold recorded runs against a model, what a unit of its time lasts has to be "
    "known: `unit 50 ms`.",
}


def model_codes() -> Mapping[str, str]:
    """The names of all such codes."""
    return RULES


def model_page(code: str) -> str | None:
    """The page of a code as Markdown; `None` if it is none of a model.

    Args:
        code: such as `TA008`; also in words, such as `diagonal-constraint`.

    >>> print(model_page("ta021"))
    # TA021 no-automaton
    <BLANKLINE>
    The model has no automaton: there is nothing to search.
    <BLANKLINE>
    Found in models (`.ta`, UPPAAL's `.xml`) and their queries: see `rvmon verify --help`.
    <BLANKLINE>
    """
    named = {name: known for known, name in RULES.items()}
    known = code.upper() if code.upper() in RULES else named.get(code.lower())
    if known is None:
        return None
    return (
        f"# {known} {RULES[known]}\n\n{_ABOUT[known]}\n\n"
        "Found in models (`.ta`, UPPAAL's `.xml`) and their queries: see `rvmon verify --help`.\n"
    )
