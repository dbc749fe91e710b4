"""A recording conforms exactly if some run of the network explains it."""

from fractions import Fraction

import pytest
from tests.tools.each import each
from tests.tools.timed_generate import random_model

from rvmon.errors import ModelError
from rvmon.models.conform import Allowed, Recorded, conform
from rvmon.models.language.load import loads_network
from rvmon.models.runs.exact_times import Rules
from rvmon.models.search.suite import Criterion, build_suite
from rvmon.trace.time import TICKS_PER_SECOND

DOOR = """
unit 1 s
clock x
automaton Door {
  location shut
  location moving invariant x <= 3
  location open invariant x <= 10
  start shut
  edge shut -> moving do x = 0 as push
  edge moving -> open when x >= 2 do x = 0 as opened
  edge open -> moving when x >= 5 do x = 0
  edge moving -> shut when x >= 2 as closed
}
"""


def check(recorded, *, end, observed=("push", "opened", "closed"), tolerance=0.0, text=DOOR):
    """Conformance of a recording, given as pairs (seconds, label)."""
    actions = [Recorded(round(t * TICKS_PER_SECOND), label) for t, label in recorded]
    return conform(
        loads_network(text),
        actions,
        observed=frozenset(observed),
        end=round(end * TICKS_PER_SECOND),
        tolerance=round(tolerance * TICKS_PER_SECOND),
    )


@each(
    ("recorded", "end", "explained", "label"),
    [
        ([], 100, 0, None),
        ([(1, "push"), (3, "opened")], 8, 2, None),
        ([(1, "push"), (4, "opened"), (14, "closed")], 14, 3, None),
        ([(1, "push"), (4, "opened"), (17, "closed"), (17, "push")], 18, 4, None),
        ([(0, "push"), (2.5, "closed"), (2.5, "push"), (4.5, "opened")], 4.5, 4, None),
        ([(1, "push"), (2.9, "opened")], 9, 1, "opened"),
        ([(1, "push"), (4.1, "opened")], 9, 1, "opened"),
        ([(1, "opened")], 9, 0, "opened"),
        ([(1, "push"), (3, "opened"), (8, "opened")], 9, 2, "opened"),
        ([(1, "push"), (2, "push")], 9, 1, "push"),
        ([(1, "push")], 4.5, 1, ""),
        ([(1, "push"), (3, "opened")], 17, 2, ""),
    ],
)
def test_a_recording_conforms_or_its_first_divergence_is_reported(recorded, end, explained, label):
    answer = check(recorded, end=end)
    assert (answer.conforms, answer.explained) == (label is None, explained)
    assert label is None or answer.divergence.label == label


def test_a_divergence_lists_what_was_allowed_instead():
    answer = check([(1, "push"), (2, "push")], end=9)
    second = TICKS_PER_SECOND
    assert set(answer.divergence.allowed) == {
        Allowed("opened", 3 * second, 4 * second),
        Allowed("closed", 3 * second, 4 * second),
    }
    quiet = check([(1, "closed")], end=9)
    assert Allowed("", 9 * second, None) in quiet.divergence.allowed


def test_an_unobserved_action_may_happen_at_any_time():
    assert check([(3, "opened")], end=3).conforms is False
    assert check([(3, "opened")], end=3, observed=("opened",)).conforms is True
    assert check([(1.9, "opened")], end=3, observed=("opened",)).conforms is False


def test_an_instant_may_be_off_by_the_tolerance_in_either_direction():
    for off in (-1.05, 1.05):
        at = 3 + off if off < 0 else 4 + off
        assert check([(1, "push"), (at, "opened")], end=6, tolerance=0.52).conforms is False
        assert check([(1, "push"), (at, "opened")], end=6, tolerance=0.53).conforms is True


def test_deviations_within_the_tolerance_do_not_add_up():
    """Each instant may deviate, but the model's clocks belong to one exact run."""
    text = """
    unit 1 s
    clock x
    automaton A { location a invariant x <= 2 start a edge a -> a when x >= 2 do x = 0 as tick }
    """
    ticks = [(2.1 * n, "tick") for n in range(1, 8)]
    assert check(ticks[:1], end=3, text=text, observed=("tick",), tolerance=0.15).conforms
    late = check(ticks, end=15, text=text, observed=("tick",), tolerance=0.15)
    assert (late.conforms, late.explained) == (False, 1)


@pytest.mark.slow
def test_every_run_of_a_network_conforms_to_it():
    for seed in range(25):
        network = loads_network(_labelled(random_model(seed)))
        try:
            suite = build_suite(network, Criterion.EDGES)
        except ModelError:
            continue
        labels = frozenset(edge.label for a in network.automata for edge in a.edges if edge.label)
        for run, _ in suite.runs:
            Rules(network).replay(run)
            now, actions = Fraction(0), []
            for step in run.steps:
                now += step.delay
                names = dict.fromkeys(e.label for _, e in step.action.edges if e.label)
                actions += [Recorded(round(now * TICKS_PER_SECOND), name) for name in names]
            end = round(now * TICKS_PER_SECOND)
            # Times with thirds and sevenths do not fall on whole milliseconds.
            answer = conform(network, actions, observed=labels, end=end, tolerance=2_000_000)
            assert answer.conforms


def _labelled(text):
    """A random model with unit 1 s and without queries, its edges labelled by their target."""
    lines = []
    for line in text.replace("network random", "network random unit 1 s").splitlines():
        words = line.split()
        lines.append(f"{line} as to_{words[3]}" if words[:1] == ["edge"] else line)
    return "\n".join(line for line in lines if not line.startswith("query"))


def test_a_model_without_a_time_unit_is_refused():
    with pytest.raises(ModelError, match="not in whole milliseconds"):
        check([], end=1, text=DOOR.replace("unit 1 s", ""))


PAIR = """
unit 1 s
chan c
clock x
automaton p { location a location b start a edge a -> b when x >= 1 on c! as snd }
automaton q { location a location b start a edge a -> b on c? as rcv }
"""
BARE = PAIR.replace(" as snd", "").replace(" as rcv", "")


@each(
    ("text", "names", "observed", "explained"),
    [
        (BARE, "c", "c", True),
        (PAIR, "c", "c", True),
        (PAIR, "rcv", "rcv", True),
        (PAIR, "snd", "snd", True),
        (PAIR, "rcv snd", "snd rcv", True),
        (PAIR, "rcv snd", "snd rcv c", False),
        (PAIR, "rcv", "snd rcv", False),
        (PAIR, "rcv rcv", "rcv", False),
    ],
)
def test_a_synchronised_move_is_observed_by_its_edge_labels_or_else_its_channel(
    text, names, observed, explained
):
    recorded = [(2, name) for name in names.split()]
    answer = check(recorded, end=3, observed=observed.split(), text=text)
    assert answer.conforms is explained
