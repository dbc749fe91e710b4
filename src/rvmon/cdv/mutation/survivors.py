"""Results of mutants: survivors as questions, and mutants that are declared equivalent.

Source: Voas 1992, PIE: A Dynamic Failure-Based Technique (a fault is detected if it is executed,
infects the state, and the infection propagates).
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from pathlib import Path

from rvmon.cdv.mutation.baseline import Difference
from rvmon.cdv.mutation.python_mutants import HELD_OUT, Mutant
from rvmon.cdv.play import Recorded
from rvmon.errors import RvmonError
from rvmon.language.checked.names_read import names_of_requirement
from rvmon.language.checked.specification import CheckedSpec
from rvmon.texts import text_of_file


class How(StrEnum):
    """The ways in which a test can kill a mutant."""

    REQUIREMENT = "requirement"
    """A requirement fails that did not fail on the unchanged code."""
    ANSWER = "known answer"
    """A verdict differs from what the test expects; on the unchanged code it did not."""
    CRASHED = "crashed"
    HUNG = "hung"
    LOST = "lost"


@dataclass(frozen=True, slots=True)
class Finding:
    """A test that kills a mutant."""

    test: str  # its name; empty: unknown, as the process ended
    how: How
    what: tuple[str, ...]  # the requirements that fail, or have an unexpected verdict; or the error


@dataclass(frozen=True, slots=True)
class Tried:
    """A mutant with the results of a suite on it."""

    mutant: Mutant
    reaching: int  # number of tests that run the changed line
    played: int = 0  # number of these that were played
    findings: tuple[Finding, ...] = ()  # its killers, in the order of the suite
    difference: Difference | None = None  # the first difference in a run that does not kill it
    invalid: str = ""  # why it cannot be planted; empty if it can
    # The first test in which a requirement fails, and its run, if runs are kept.
    failing: tuple[str, Recorded] | None = field(default=None, compare=False)

    @property
    def killed(self) -> bool:
        """Whether a test kills the mutant."""
        return bool(self.findings)

    @property
    def killed_by_requirement(self) -> bool:
        """Whether a requirement fails on the mutant; known answers and crashes do not count."""
        return any(finding.how is How.REQUIREMENT for finding in self.findings)


@dataclass(frozen=True, slots=True)
class Score:
    """Numbers of mutants."""

    mutants: int  # all that can be planted
    equivalent: int  # declared or proved equivalent, and not killed
    killed: int  # in any way
    by_requirement: int  # killed by a requirement that fails
    unreached: int  # in lines that no test runs

    @property
    def rest(self) -> int:
        """The number of mutants that are not equivalent."""
        return self.mutants - self.equivalent


def failing_runs(tried: Iterable[Tried]) -> dict[str, Recorded]:
    """The kept failing runs of mutants that are not held out, by a text of test and mutant."""
    return {
        f"{trial.failing[0]} with {trial.mutant.identity}": trial.failing[1]
        for trial in tried
        if trial.failing is not None and trial.mutant.third != HELD_OUT
    }


def scored(tried: Iterable[Tried], equivalent: Iterable[str] = ()) -> Score:
    """The score on mutants of code; `equivalent` has the identities of those declared so."""
    counted = [trial for trial in tried if not trial.invalid]
    known = set(equivalent)
    return Score(
        len(counted),
        sum(trial.mutant.identity in known and not trial.killed for trial in counted),
        sum(trial.killed for trial in counted),
        sum(trial.killed_by_requirement for trial in counted),
        sum(not trial.reaching for trial in counted),
    )


class Missing(StrEnum):
    """What a suite with a surviving mutant probably lacks."""

    REQUIREMENT = "requirement"
    OBSERVATION = "observation"
    STIMULUS = "stimulus"


TITLES = {
    Missing.REQUIREMENT: "The run differs, and no requirement fails: is a requirement missing?",
    Missing.OBSERVATION: (
        "It runs, and nothing that is recorded differs: is an observation missing, or a stimulus, "
        "or is it equivalent?"
    ),
    Missing.STIMULUS: "No test runs it: is a stimulus missing?",
}


def missing(survivor: Tried) -> Missing:
    """What the suite probably lacks, given a surviving mutant."""
    if not survivor.reaching:
        return Missing.STIMULUS
    return Missing.OBSERVATION if survivor.difference is None else Missing.REQUIREMENT


def readers(spec: CheckedSpec) -> dict[str, list[str]]:
    """The ids of the requirements that read each signal or event, by its name."""
    readers_of: dict[str, list[str]] = {}
    for requirement in spec.requirements.values():
        for name in sorted(set(names_of_requirement(requirement))):
            readers_of.setdefault(name, []).append(requirement.id)
    return readers_of


def question(survivor: Tried, reading: Mapping[str, Sequence[str]]) -> str:
    """What the suite saw of a survivor, as a sentence; `reading` is the result of `readers`.

    >>> from pathlib import Path
    >>> from rvmon.cdv.mutation.python_mutants import Mutant
    >>> mutant = Mutant(Path("a.py"), 3, "constant", "x = 3", "x = 4", "x = 4")
    >>> question(Tried(mutant, 2, 2, (), Difference("t", 1_500_000_000, "beep", "", "True")), {})
    'in `t` the run differs at 1.5 s in `beep` (none → True), which no requirement reads'
    """
    if survivor.difference is not None:
        return _differs(survivor.difference, reading)
    if survivor.reaching == 1:
        return "one test runs it, and nothing that is recorded differs"
    if survivor.reaching:
        return f"{survivor.reaching} tests run it, and nothing that is recorded differs"
    return "no test runs it"


def _differs(difference: Difference, reading: Mapping[str, Sequence[str]]) -> str:
    instant = f"{difference.t_ns / 1e9:.9g} s"
    if not difference.name:
        return f"in `{difference.test}` the run ends at {instant}, and no requirement fails"
    values = f"{difference.was or 'none'} → {difference.now or 'none'}"
    requirements = reading.get(difference.name, ())
    verb = "reads" if len(requirements) == 1 else "read"
    who = f"{', '.join(requirements)} {verb}" if requirements else "no requirement reads"
    place = f"at {instant} in `{difference.name}` ({values})"
    text = f"in `{difference.test}` the run differs {place}, which {who}"
    if difference.verdicts:
        changes = ", ".join(f"{name} {was} → {now}" for name, was, now in difference.verdicts)
        text += f"; verdicts differ, but none is a failure: {changes}"
    return text


def equivalents(path: str | Path, mutants: Iterable[Mutant]) -> dict[str, str]:
    """Read a TOML file of equivalent mutants.

    Each table has an argument, `because`, and `mutants`, the changes by identity. `mutants` are all
    mutants of the code.

    Returns:
        The argument for each equivalent mutant, by its identity.

    Raises:
        RvmonError: the file cannot be read or is not of this form, it names an unknown mutant, or
            the code has changed so that an identity now stands for another change.
    """
    try:
        document = tomllib.loads(text_of_file(path))
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise RvmonError(f"{path}: not TOML: {error}") from None
    known = {mutant.identity: mutant.brief for mutant in mutants}
    arguments: dict[str, str] = {}
    for name, entry in document.items():
        match entry:
            case {"because": str() as because, "mutants": dict() as changes, **rest} if (
                because.strip() and not rest
            ):
                _refuse_others(path, changes, known)
                arguments |= dict.fromkeys(changes, because)
            case _:
                raise RvmonError(
                    f"{path}: `{name}` must have an argument, `because`, and `mutants`: their "
                    "changes by their names, as --list shows them"
                )
    return arguments


def _refuse_others(
    path: str | Path, changes: Mapping[str, object], known: Mapping[str, str]
) -> None:
    for name, change in changes.items():
        if name not in known:
            raise RvmonError(f"{path}: no mutant `{name}`: --list lists them")
        if change != known[name]:
            raise RvmonError(
                f"{path}: `{name}` is now another change, {known[name]}: check whether it is "
                "equivalent, and correct the entry"
            )
