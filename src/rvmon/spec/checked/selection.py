"""What a caller asks for by name, all of which there is."""

from __future__ import annotations

from collections.abc import Collection, Iterable

from rvmon.diagnostics.nearest import did_you_mean
from rvmon.errors import UnknownNameError
from rvmon.spec.checked.specification import CheckedSpec, Requirement


def requirements_asked(spec: CheckedSpec, only: Iterable[str] | None) -> tuple[str, ...] | None:
    """Ids of requirements; `None`: all.

    Raises:
        UnknownNameError: there is no such requirement.
    """
    chosen = None if only is None else tuple(only)
    for name in chosen or ():
        if name not in spec.requirements:
            known = ", ".join(spec.requirements) or "none"
            raise UnknownNameError(f"no requirement `{name}`: there are {known}")
    return chosen


def labelled(
    spec: CheckedSpec,
    only: Iterable[str] | None,
    severities: Iterable[Collection[str]],
    tags: Iterable[Collection[str]],
) -> tuple[str, ...]:
    """Ids of the requirements that have, of each list, one of the severities or tags in it.

    Args:
        spec: with the requirements.
        only: ids among which is chosen, which exist; `None`: all.
        severities: lists of severities.
        tags: lists of tags.

    Raises:
        UnknownNameError: no requirement has such a severity or tag, or none has one of each list.
    """
    left = list(spec.requirements) if only is None else list(only)
    wanted = [("severity", one) for one in severities] + [("tag", one) for one in tags]
    for kind, words in wanted:
        of = {name: _labels(one, kind) for name, one in spec.requirements.items()}
        known = sorted(set().union(*of.values()))
        for word in words or [""]:
            if word not in known:
                there = f"there are {', '.join(known)}" if known else f"none has a {kind}"
                meant = did_you_mean(word, known, there)
                raise UnknownNameError(f"no requirement has the {kind} `{word}`: {meant}")
        left = [name for name in left if not of[name].isdisjoint(words)]
    if not left:
        asked = ", ".join(f"the {kind} {' or '.join(words)}" for kind, words in wanted)
        raise UnknownNameError(f"no requirement that is asked for has {asked}")
    return tuple(left)


def _labels(requirement: Requirement, kind: str) -> set[str]:
    return set(requirement.tags) if kind == "tag" else {requirement.severity} - {""}


def sources_asked(spec: CheckedSpec, names: Iterable[str] | None) -> frozenset[str] | None:
    """Names of signals and events; `None`: all.

    Raises:
        UnknownNameError: there is no such signal or event.
    """
    given = None if names is None else frozenset(names)
    declared = [*spec.signals, *spec.events]
    for name in sorted((given or frozenset()).difference(declared)):
        meant = did_you_mean(name, declared, f"there are {', '.join(declared)}")
        raise UnknownNameError(f"no signal or event named `{name}`: {meant}")
    return given
