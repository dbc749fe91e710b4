"""Difference bound matrices: sets of clock valuations, and what happens to them.

A zone over `n` clocks is a flat list of `dim²` floats, `dim = n + 1`; clock 0 is always zero. The
entry at `x * dim + y` bounds `clock y − clock x` from above; no bound is infinity. A strict bound
`< c` is the number `c − STRICT`, so that adding and comparing bounds needs no branch; sums of
several strict bounds lie a few `STRICT` lower and are brought back by `normalise`.
All zones are kept closed (every entry is the tightest implied bound) and not empty.

Source: Bengtsson and Yi, Timed Automata: Semantics, Algorithms and Tools, 2004, section 4.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import ceil, inf

Zone = list[float]

STRICT = 2.0**-12
"""What a strict bound lacks; sums of hundreds of bounds below `MAX_TIME` stay exact."""

MOST_TIDY = 1 << 16
"""Tidied bounds that are remembered."""


Atom = tuple[int, int, float]
"""`(x, y, bound)`: clock y − clock x is at most the bound."""


def bound_of(number: int, strict: bool) -> float:
    """The bound `<= number`, or `< number` if strict."""
    return number - STRICT if strict else float(number)


def negated(atom: Atom) -> Atom:
    """What holds where a bound does not."""
    x, y, bound = atom
    return y, x, -bound - STRICT


def zero(dim: int) -> Zone:
    """The zone in which every clock is 0."""
    return [0.0] * (dim * dim)


def universe(dim: int) -> Zone:
    """All valuations."""
    zone = [inf] * (dim * dim)
    for clock in range(dim):
        zone[clock * dim] = zone[clock * dim + clock] = 0.0
    return zone


def constrain(zone: Zone, dim: int, x: int, y: int, bound: float) -> bool:
    """Cut a zone by `clock y − clock x <= bound`, in place.

    Returns:
        False if nothing is left; the zone is then undefined.
    """
    if zone[x * dim + y] <= bound:
        return True
    if zone[y * dim + x] + bound < 0:
        return False
    row = zone[y * dim : y * dim + dim]
    for base in range(0, dim * dim, dim):
        through = zone[base + x] + bound
        if through < zone[base + y]:
            # Only rows whose entry at y improves can improve elsewhere, for the zone is closed.
            zone[base : base + dim] = [
                new if (new := through + step) < old else old
                for step, old in zip(row, zone[base : base + dim], strict=True)
            ]
    return True


def cut(zone: Zone, dim: int, atoms: Iterable[Atom]) -> bool:
    """Cut a zone by several atoms, in place; False if nothing is left."""
    return all(constrain(zone, dim, x, y, bound) for x, y, bound in atoms)


def reset(zone: Zone, dim: int, clock: int, value: float) -> None:
    """Set a clock, in place."""
    base = clock * dim
    zone[base : base + dim] = zone[0:dim]
    zone[clock::dim] = zone[0::dim]
    if value:
        for other in range(dim):
            zone[base + other] -= value
            zone[other * dim + clock] += value
    zone[base + clock] = 0.0


def delay(zone: Zone, dim: int) -> None:
    """Let any time pass, in place."""
    zone[1:dim] = [inf] * (dim - 1)


def delay_within(zone: Zone, dim: int, uppers: Sequence[tuple[int, float]]) -> bool:
    """Let time pass as long as `clock <= bound` holds for all of `uppers`, in place.

    One pass closes the zone: after the delay nothing bounds the clocks from above, so that a
    tightest path uses exactly one of the new bounds. If all bounds hold before the delay, as they
    mostly do, they cut nothing off and only the bounds from above change.

    Returns:
        False if a bound is broken at once; the zone is then undefined.
    """
    if not uppers:
        zone[1:dim] = [inf] * (dim - 1)
        return True
    holds = all(zone[clock] <= bound for clock, bound in uppers)
    clock, bound = uppers[0]
    top = [bound + step for step in zone[clock * dim : clock * dim + dim]]
    for clock, bound in uppers[1:]:
        row = zone[clock * dim : clock * dim + dim]
        top = [
            new if (new := bound + step) < old else old for step, old in zip(row, top, strict=True)
        ]
    if holds:
        zone[1:dim] = top[1:]
        return True
    for y in range(dim):
        if top[y] + zone[y * dim] < 0:
            return False
    top[0] = 0.0
    zone[0:dim] = top
    for base in range(dim, dim * dim, dim):
        down = zone[base]
        zone[base : base + dim] = [
            new if (new := down + step) < old else old
            for step, old in zip(top, zone[base : base + dim], strict=True)
        ]
    return True


def normalise(zone: Zone) -> Zone:
    """The zone with each strict bound exactly `STRICT` below its number."""
    return list(map(_TIDY.__getitem__, zone))


def blurred(zone: Zone, dim: int, most: Sequence[float]) -> Zone:
    """A zone with what lies above the largest numbers blurred, up to bisimulation (Extra_M).

    Args:
        zone: normalised.
        dim: of it.
        most: for each clock its number; −inf frees it.

    Source: Behrmann, Bouyer, Larsen, Pelánek, Lower and Upper Bounds in Zone-Based Abstractions of
    Timed Automata, 2006, section 3.
    """
    wide = zone[:]
    for x in range(dim):
        for y in range(dim):
            bound, least = zone[x * dim + y], most[x]
            if x == y:
                continue
            if bound > most[y]:
                wide[x * dim + y] = inf
            elif x and bound < -least - STRICT:
                wide[x * dim + y] = inf if y and least == -inf else min(0.0, -least - STRICT)
    if wide == zone:
        return wide
    for k in range(dim):
        for x in range(dim):
            for y in range(dim):
                through = wide[x * dim + k] + wide[k * dim + y]
                wide[x * dim + y] = min(wide[x * dim + y], through)
    return normalise(wide)


class _Tidy(dict[float, float]):
    """Bounds with one `STRICT` at most; each is worked out once, for a search meets few."""

    def __missing__(self, value: float) -> float:
        if len(self) >= MOST_TIDY:
            self.clear()
        whole = value if value == inf else ceil(value)
        tidy = self[value] = value if value == whole else whole - STRICT
        return tidy


_TIDY = _Tidy()


CoverTest = tuple[tuple[int, float], ...]
"""`(entry, least)`: a zone that simulates another has at least these numbers there."""


def cover_test(
    zone: Zone,
    dim: int,
    uppers: Sequence[tuple[int, float]],
    lowers: Sequence[tuple[int, float]],
) -> CoverTest:
    """What a zone must pass for each valuation of this one to be simulated: `this ⊆ aLU(other)`.

    Args:
        zone: normalised, as the other is.
        dim: of both.
        uppers: `(clock, −U)` for each clock with an upper bound U in some guard, `(0, 0)` first.
        lowers: `(clock, L)` for each clock with a lower bound L in some guard, `(0, 0)` first.

    Source: Herbreteau, Srivathsan, Walukiewicz, Better Abstractions for Timed Automata, LICS 2012,
    theorem on inclusion.
    """
    test: list[tuple[int, float]] = []
    for x, minus_upper in uppers:
        base = x * dim
        low = zone[base]
        if low >= minus_upper:
            # Strictly below: a bound `< c` must be as tight as `< c`, less so than `<= c`.
            limit = ceil(low + STRICT / 2) - 1 + STRICT / 2
            test += [
                (base + y, bound if (bound := zone[base + y]) < limit + lower else limit + lower)
                for y, lower in lowers
                if x != y
            ]
    return tuple(test)


def passes(zone: Zone, test: CoverTest) -> bool:
    """Whether a zone passes a test."""
    for entry, least in test:  # noqa: SIM110 - a generator costs more than the comparisons
        if zone[entry] < least:
            return False
    return True
