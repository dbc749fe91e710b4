"""What an engine cannot judge, and why: all of it stands here."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rvmon.automaton.letter_classes import LetterDiagram
from rvmon.errors import RvmonError
from rvmon.formula.numeric import operands
from rvmon.spec.checked.formula import (
    Compare,
    Literal,
    Probe,
    ProbeAtom,
    SignalValue,
)

if TYPE_CHECKING:
    from rvmon.formula.state import Leaf
    from rvmon.monitor.compiled.requirement import CompiledRequirement


@dataclass(frozen=True, slots=True)
class Refusal:
    """Why an engine does not judge a requirement.

    Attributes:
        reason: why the requirement is refused, such as "uses `let`".
        fix: what to do.
        engine: the one that takes it.
    """

    reason: str
    fix: str
    engine: str

    def error(self, requirement: str, what: str) -> RvmonError:
        """The error of one that was asked for by name."""
        return RvmonError(f"{requirement} {self.reason}; {what} cannot evaluate it: {self.fix}")


def refuse(
    requirements: Iterable[CompiledRequirement],
    refuses: Callable[[CompiledRequirement], Refusal | None],
    what: str,
) -> None:
    """Refuse what an engine that was asked for by name cannot judge.

    Raises:
        RvmonError: there is such a requirement; which one and why is in the message.
    """
    for one in requirements:
        refusal = refuses(one)
        if refusal is not None:
            raise refusal.error(one.requirement.id, what)


MOST_GENERATED = 2000
"""For more requirements no code is generated: it has a bit for each in numbers that it names."""

_MOST_LEAVES = 39
"""So many truth values fit into a number of 64 bits."""

STEPS_EACH = "its automaton steps each open attempt"
"""Why windows judge what `CompiledRequirement.follows_windows`."""

_AUTO = "use the engine `auto`"
_LEAVE_OUT = "leave it out (`only`, --only), or use the engine `auto`"


def too_many(count: int) -> Refusal:
    """More requirements than code is generated for."""
    reason = f"is one of {count} requirements, more than the {MOST_GENERATED} of generated code"
    return Refusal(reason, "use the engine `auto`, or several monitors (`only`)", "automaton")


def no_stream(engine: str) -> RvmonError:
    """A stream for an engine of recordings."""
    return RvmonError(f"the engine `{engine}` evaluates recordings, not streams: {_AUTO}")


def no_columns(why: Exception) -> RvmonError:
    """A recording without columns for the engine of columns."""
    return RvmonError(f"the recording is not evaluated by columns: {why}: {_AUTO}")


def of_automaton(one: CompiledRequirement) -> Refusal | None:
    """What has no automaton."""
    if one.automaton is None:
        return Refusal(f"has no automaton ({one.refusal})", _AUTO, "network")
    return None


def of_network(one: CompiledRequirement) -> Refusal | None:
    """Nothing."""


def of_progression(one: CompiledRequirement) -> Refusal | None:
    """What looks back at what lies ahead."""
    if one.network_plan.looks_back:
        fix = "use the engine `auto` or `network`"
        return Refusal("looks back at what lies ahead", fix, "network")
    return None


def _of_captured(one: CompiledRequirement) -> Refusal | None:
    """What has propositions of its own in each instance or attempt."""
    tables = "automaton" if one.automaton is not None else "network"
    if one.requirement.for_each:
        return Refusal("uses `for each`", _LEAVE_OUT, tables)
    if one.requirement.captures:
        return Refusal("uses `let`", _LEAVE_OUT, tables)
    return None


def of_generated(one: CompiledRequirement) -> Refusal | None:
    """What generated Python cannot judge."""
    if one.follows_windows:
        fix = "use the engine `auto`, or `automaton` where few attempts are open at once"
        return Refusal(f"is judged in windows ({STEPS_EACH})", fix, "network")
    return _of_captured(one) or of_tables(one)


def _by_samples(one: CompiledRequirement) -> str:
    """The engine of `auto` that takes its samples one by one."""
    return "python" if of_generated(one) is None else one.engine("auto")


def of_tables(one: CompiledRequirement) -> Refusal | None:
    """What generated code has no automaton for."""
    if one.automaton is None:
        return Refusal(f"has no automaton ({one.refusal})", _LEAVE_OUT, "network")
    if isinstance(one.automaton.class_of, LetterDiagram):
        reason = f"distinguishes {one.alphabet.size:,} combinations of its propositions"
        return Refusal(reason, _LEAVE_OUT, "automaton")
    return None


def of_columns(one: CompiledRequirement) -> Refusal | None:
    """What is not judged by arrays: it needs more than one clock, or more than present values."""
    generated = _of_captured(one) or of_tables(one)
    reason = _beyond_columns(one) if generated is None else generated.reason
    return Refusal(reason, _AUTO, _by_samples(one)) if reason else None


def _beyond_columns(one: CompiledRequirement) -> str:
    from rvmon.automaton.moves import moves_of

    judged = [one, *(() if one.hidden is None else (one.hidden,))]
    leaves = [state.leaf for each in judged for state, _ in each.leaves]
    stale = {name for name, signal in one.spec.signals.items() if signal.stale_after}
    if one.spec.max_delay is not None:
        return "has samples that come late (`max delay`)"
    if one.gap not in (None, 1):
        return "is clocked (`sampled every`)"
    if one.obligation.trigger is None:
        return "is evaluated at the end (`upon end`)"
    if found := sorted(stale & one.reads):
        return f"reads `{found[0]}`, which becomes stale"
    if any(len(each.leaves) > _MOST_LEAVES for each in judged):
        return f"reads more than {_MOST_LEAVES} propositions"
    if not all(leaf is None or _is_present(leaf) for leaf in leaves):
        return "reads labels, payloads, or what was before"
    # What judges attempts in doubt is only looked at where there are some.
    if one.automaton is None or moves_of(one.automaton, one.gap) is None:
        return "has an automaton of more than one clock, or of too many locations"
    return ""


def _is_present(leaf: Leaf) -> bool:
    match leaf:
        case ProbeAtom(probe=probe):
            return probe is not Probe.CHANGED
        case Compare(left=left, right=right):
            return all(
                isinstance(part, SignalValue)
                or (isinstance(part, Literal) and not isinstance(part.value, str))
                for side in (left, right)
                for part in operands(side)
            )
        case _:
            return True
