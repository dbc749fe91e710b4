"""Residuals: the formula an attempt has yet to satisfy, as a reduced DNF of timed atoms.

Source: AUTOMATA 1; reduced DNFs of monotone functions are their prime implicants (Quine 1952).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache

from rvmon.logic.formula import Core, Literal, Next, Release, Until

NO_CLOCK = -1  # the clock of an atom that does not depend on when it was instantiated

Atom = tuple[Literal | Next | Until | Release, int]
"""A subformula and the clock of its age; clocks are numbered from 0, oldest first.

Literals are atoms only while a step is computed for all letters at once.
"""

Clause = frozenset[Atom]
Residual = frozenset[Clause]
"""A disjunction of conjunctions of atoms, without redundant clauses or atoms."""

HOLDS: Residual = frozenset([frozenset()])
FAILS: Residual = frozenset()

_MOST_PAIRS = 1 << 10
"""The most pairs of clauses that `both` reduces under a limit, whatever the limit."""

_KEPT = 1 << 12
"""The size of the caches of `both` and `_reduced`: building an automaton repeats most of these
operations in each region and at each letter."""


class TooManyClausesError(Exception):
    """A residual exceeded its limit of clauses."""


def _follows(atom: Atom, clause: Clause) -> bool:
    """Whether another atom of `clause` implies `atom` for every continuation and every end.

    All atoms are pending. Of `U[0,b]` the earlier deadline implies the later one, of `R[0,b]` the
    later implies the earlier. Of `U[a,inf)` the later implies the earlier, and also the opened
    window. Of `R[a,inf)` neither implies the other: logically the earlier is stronger, but at the
    end of a trace only an opened window counts as true.
    """
    node, clock = atom
    match node:
        case Until(high=None):
            return any(
                its > clock if other is node else isinstance(other, Until) and other.opened is node
                for other, its in clause
            )
        case Until(low=0):
            return any(other is node and its < clock for other, its in clause)
        case Release(low=0, high=int()):
            return any(other is node and its > clock for other, its in clause)
        case _:
            return False


def either(left: Residual, right: Residual) -> Residual:
    """The reduced disjunction."""
    if left == right or not right:
        return left
    if not left:
        return right
    return _reduced(left | right)


@lru_cache(_KEPT)
def both(left: Residual, right: Residual, limit: int | None = None) -> Residual:
    """The reduced conjunction.

    Raises:
        TooManyClausesError: it has more than `limit` clauses, or is too long to be reduced.
    """
    if left == right or right == HOLDS:
        return left
    if left == HOLDS:
        return right
    # Check before the product is made: it may take all memory, even if its reduced form is short.
    if limit is not None and len(left) * len(right) > max(limit, _MOST_PAIRS):
        raise TooManyClausesError
    made = _reduced(frozenset(_conjunction(clause | other) for clause in left for other in right))
    if limit is not None and len(made) > limit:
        raise TooManyClausesError
    return made


def _conjunction(clause: Clause) -> Clause:
    """The conjunction without atoms that others in it imply."""
    if len(frozenset(map(_family, clause))) == len(clause):  # no atom implies another
        return clause
    implied = [atom for atom in clause if _follows(atom, clause)]
    return clause.difference(implied) if implied else clause


@lru_cache(_KEPT)
def _reduced(clauses: Residual) -> Residual:
    """The residual of clauses without implied atoms: clauses that imply another one are dropped."""
    if len(clauses) < 2:
        return clauses
    # The shortest first: mostly the shorter clause is the implied one, so that a longer one is
    # dropped at once.
    ordered = sorted(clauses, key=len)
    if not ordered[0]:
        return HOLDS
    kept: list[Clause] = []
    families: dict[Clause, frozenset[Atom | Core]] = {}
    for clause in ordered:
        if any(map(clause.issuperset, kept)):
            continue
        own = families[clause] = frozenset(map(_family, clause))
        # The subset tests are cheap and settle most pairs; `_clause_implies` is quadratic in the
        # atoms.
        if not any(families[one] <= own and _clause_implies(clause, one) for one in kept):
            # By `_follows` a short clause can imply a longer one, so the kept ones are rechecked.
            kept = [
                one for one in kept if not (own <= families[one] and _clause_implies(one, clause))
            ]
            kept.append(clause)
    return frozenset(kept)


def _family(atom: Atom) -> Atom | Core:
    """A key that an atom shares with all atoms that may imply it."""
    node = atom[0]
    return node.opened or node if isinstance(node, Until | Release) else atom


def _clause_implies(strong: Clause, weak: Clause) -> bool:
    return all(_follows(atom, strong) for atom in weak - strong)


def substitute(
    residual: Residual, values: Mapping[Atom, Residual], limit: int | None = None
) -> Residual:
    """The residual with some of its atoms replaced.

    Raises:
        TooManyClausesError: an intermediate result may have more than `limit` clauses.
    """
    found: set[Clause] = set()
    # Sets have no fixed order, but whether an intermediate result exceeds the limit must not vary
    # between runs.
    clauses = (
        residual if limit is None else sorted(residual, key=lambda c: sorted(map(_by_number, c)))
    )
    for clause in clauses:
        made: Residual = frozenset([clause.difference(values)])
        for atom in clause if limit is None else sorted(clause, key=_by_number):
            if atom in values:
                made = both(made, values[atom], limit)
        found |= made
        if limit is not None and len(found) > limit:
            found = set(_reduced(frozenset(found)))
    return _reduced(frozenset(found))


def decided(residual: Residual, true: Clause, false: Clause) -> Residual:
    """The residual in which some of its atoms are true and others false."""
    left = frozenset(filter(false.isdisjoint, residual))
    if all(map(true.isdisjoint, left)):
        return left  # a subset of a reduced residual is reduced
    return _reduced(frozenset(clause.difference(true) for clause in left))


def _by_number(atom: Atom) -> tuple[int, int]:
    return atom[0].id, atom[1]
