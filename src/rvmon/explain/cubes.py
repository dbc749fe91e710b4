"""Sets of truth vectors as few conditions."""

from __future__ import annotations

from collections.abc import Collection, Iterable

Cube = tuple[int, ...]
"""Per proposition 1, 0, or `ANY`."""

ANY = -1


def cubes_of(vectors: Iterable[Cube], never: Collection[Cube] = ()) -> tuple[Cube, ...]:
    """Cubes that cover these vectors: prime ones, chosen greedily.

    Source: Quine 1952, McCluskey 1956; the choice of primes is greedy.

    >>> cubes_of([(0, 0), (0, 1), (1, 1)])
    ((0, -1), (-1, 1))
    """
    wanted = set(vectors)
    primes = _primes(wanted | {*never})
    missing = set(wanted)
    chosen: list[Cube] = []
    while missing:
        best = max(primes, key=lambda cube: (sum(_covers(cube, one) for one in missing), cube))
        chosen.append(best)
        missing = {one for one in missing if not _covers(best, one)}
    return tuple(sorted(chosen, key=lambda cube: (cube.count(ANY), cube[::-1])))


def _primes(vectors: set[Cube]) -> list[Cube]:
    primes: list[Cube] = []
    level = set(vectors)
    while level:
        merged: set[Cube] = set()
        used: set[Cube] = set()
        for cube in level:
            for place, truth in enumerate(cube):
                other = (*cube[:place], 1 - truth, *cube[place + 1 :])
                if truth != ANY and other in level:
                    merged.add((*cube[:place], ANY, *cube[place + 1 :]))
                    used |= {cube, other}
        primes += sorted(level - used)
        level = merged
    return primes


def _covers(cube: Cube, vector: Cube) -> bool:
    return all(own in (ANY, truth) for own, truth in zip(cube, vector, strict=True))
