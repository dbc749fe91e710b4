"""What an engine cannot judge, and why: all of it stands here."""

from __future__ import annotations

from collections.abc import Callable, Container, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rvmon.automaton.letter_classes import LetterDiagram
from rvmon.errors import RvmonError
from rvmon.formula.numeric import operands
from rvmon.formula.state import FALSE, TRUE, UNKNOWN, Lapsed, Lost, StateOp, Unborn
from rvmon.plan.graph import Graph, graph_of
from rvmon.spec.checked.arithmetic import NumericOp
from rvmon.spec.checked.formula import (
    Arithmetic,
    Compare,
    Constant,
    Literal,
    Numeric,
    Probe,
    ProbeAtom,
    SignalValue,
)
from rvmon.trace.schema import Kind

if TYPE_CHECKING:
    from rvmon.formula.state import Leaf, State
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

_MOST_BITS = 64
"""So many of them stand in a letter that is noted."""

_MOST_STRETCHES = 64
"""So many stretches of time a past operator of compiled code remembers."""

_MANY = "remembers more than 60 stretches of time"

_MODERATE = 1e50
"""Sums and a few products of numbers up to this magnitude are finite."""

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


def no_dropping(engine: str) -> RvmonError:
    """Records to be dropped, for an engine that keeps all."""
    return RvmonError(f"the engine `{engine}` keeps all records: leave out `keep`, or use `auto`")


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


def of_c(one: CompiledRequirement) -> Refusal | None:
    """What generated code cannot judge without a monitor in this process."""
    if one.spec.max_delay is not None:
        fix = "leave out `max delay`, or use the engine `auto`"
        return Refusal("has samples that come late (`max delay`)", fix, _by_samples(one))
    # C has only the latest values, which may be newer than the last tick.
    if one.obligation.trigger is None and one.requirement.captures and one.gap not in (None, 1):
        reason = "captures values `upon end`, which may be newer than the last tick of its clock"
        return Refusal(reason, _AUTO, _by_samples(one))
    return None


def of_measured_c(one: CompiledRequirement) -> Refusal | None:
    """What compiled C does not measure."""
    reason = ""
    if one.obligation.trigger is None:
        reason = "is evaluated `upon end`"
    elif one.gap not in (None, 1):
        reason = "has a clock of several ticks"
    elif one.measures_payloads:
        reason = "compares payloads"
    own = Refusal(reason, _LEAVE_OUT, _by_samples(one)) if reason else None
    return of_c(one) or _of_captured(one) or own


def of_prepared(one: CompiledRequirement) -> Refusal | None:
    """What `auto` does not have compiled C judge, be that prepared: Python does all of it."""
    by_network = one.engine("auto") == "network"
    generated = _of_captured(one) if by_network else of_generated(one)
    reason = _beyond_prepared(one) if generated is None else generated.reason
    return Refusal(reason, _AUTO, _by_samples(one)) if reason else None


def of_prepared_margins(one: CompiledRequirement) -> Refusal | None:
    """What `auto` does not have compiled C measure, be that prepared."""
    refusal = of_measured_c(one)
    kinds = {one.spec.signals[name].type.kind for name in one.reads & {*one.spec.signals}}
    reason = ""
    if Kind.INT in kinds:  # C has doubles alone
        reason = "reads whole numbers"
    elif any(map(_keeps_many, one.shared_graph.nodes)):
        reason = _MANY
    return refusal or (Refusal(reason, _AUTO, _by_samples(one)) if reason else None)


def _beyond_prepared(one: CompiledRequirement) -> str:
    if one.automaton is None and one.reach is None:
        return f"has no automaton ({one.refusal}), nor bounds within what `always` demands"
    if len(one.network_plan.leaves) > _MOST_BITS and one.engine("auto") == "network":
        return f"distinguishes more than {_MOST_BITS} propositions"
    if one.spec.max_delay is not None:
        return "has samples that come late (`max delay`)"
    if one.gap not in (None, 1) and one.single_payloads:
        return "has a clock (`sampled every`) and reads payloads"
    if len(one.leaves) > _MOST_LEAVES:
        return f"reads more than {_MOST_LEAVES} propositions"
    obligation = one.obligation
    named = (obligation.trigger, obligation.again, obligation.unborn)
    asked = {*named, *one.alphabet.propositions} - {None}
    known = graph_of(state for state in asked if state is not None)
    others = [state for state in one.shared_graph.nodes if state not in known.index]
    if _may_be_unknown(known, asked):
        return "compares what may be unknown though all signals are known"
    if any(map(_keeps_many, known.nodes)):
        return _MANY
    hidden = one.hidden
    if (hidden is not None and hidden.network_plan.looks_back) or any(map(_remembers, others)):
        return "remembers what it needs for attempts in doubt only"
    return ""


def _may_be_unknown(graph: Graph, asked: Container[State | None]) -> bool:
    """Whether what is asked for, or remembered, may be unknown though all signals are known."""
    found: list[int | None] = []  # a truth that stays; `None`: it is known, whatever it is
    for state, operands_ in zip(graph.nodes, graph.operands, strict=True):
        found.append(_lasting(state, [found[place] for place in operands_]))
    return any(
        truth == UNKNOWN and (state in asked or state.op in (StateOp.SINCE, StateOp.PREVIOUS))
        for truth, state in zip(found, graph.nodes, strict=True)
    )


def _lasting(state: State, operands_: Sequence[int | None]) -> int | None:
    """The truth that a state formula keeps, all signals being known; UNKNOWN if it may be that."""
    if state.leaf is not None:
        return _lasting_leaf(state.leaf)
    decisive = {StateOp.AND: FALSE, StateOp.OR: TRUE}.get(state.op)
    if decisive is not None and decisive in operands_:
        return decisive
    if UNKNOWN in operands_:
        return UNKNOWN
    return None


def _lasting_leaf(leaf: Leaf) -> int | None:
    match leaf:
        case Lost() | Lapsed():
            return UNKNOWN
        case Constant(value=value):
            return TRUE if value else FALSE
        case Unborn():
            return FALSE
        case Compare(left=left, right=right):
            return UNKNOWN if _is_wild(left) or _is_wild(right) else None
        case _:
            return None


def _is_wild(expression: Numeric, products: int = 3) -> bool:
    """Whether a number may be none, or infinite, though its operands are moderate."""
    match expression:
        case Literal(value=value):
            return not isinstance(value, str) and abs(value) > _MODERATE
        case Arithmetic(op=NumericOp.SQRT):
            return True
        case Arithmetic(op=NumericOp.DIV, args=(_, divisor)) if not _divides(divisor):
            return True
        case Arithmetic(op=op, args=args):
            left = products - (op in (NumericOp.MUL, NumericOp.DIV))
            return left < 0 or any(_is_wild(part, left) for part in args)
        case _:
            return False


def _divides(expression: Numeric) -> bool:
    """Whether a number is a divisor that is not too small."""
    match expression:
        case Literal(value=float() | int() as value):
            return abs(value) * _MODERATE > 1
        case _:
            return False


def _keeps_many(state: State) -> bool:
    """Whether a past operator may remember more stretches of time than compiled code can."""
    if state.op is not StateOp.SINCE or state.low == 0 or state.high is None:
        return False
    return state.high // (state.high - state.low + 1) > _MOST_STRETCHES - 4


def _remembers(state: State) -> bool:
    """Whether the value of a node that only attempts in doubt need is not seen from the present."""
    if state.op is StateOp.SINCE:
        return state.args[0].leaf != Constant(True) or state.low > 0 or state.high is not None
    return state.op is StateOp.PREVIOUS or (state.op is StateOp.DOUBT and state.every)


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
