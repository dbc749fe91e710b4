"""Small networks show each rule of the step by what can and cannot be reached."""

import pytest

from rvmon.errors import ModelError
from rvmon.timed.language.elaborate import asked_on
from rvmon.timed.language.load import loads_network
from rvmon.timed.runs.run import Window
from rvmon.timed.runs.statistics import sample
from rvmon.timed.search.verify import verify


def holds(text, query):
    return verify(loads_network(text), query).holds


PAIR = """
{kind}chan c
clock x
int[0,3] heard
automaton Sender {{ location s {invariant} location t start s edge s -> t {guard} on c! }}
automaton Left {{ location l location m start l edge l -> m on c? do heard = heard + 1 }}
automaton Right {{ location l location m start l edge l -> m on c? do heard = heard * 2 }}
"""


def test_binary_channel_has_one_receiver():
    """One of two possible receivers takes part, never both."""
    text = PAIR.format(kind="", invariant="", guard="")
    assert holds(text, "E<> Left.m") is True
    assert holds(text, "E<> Right.m") is True
    assert holds(text, "E<> Left.m and Right.m") is False


def test_broadcast_takes_all_receivers_in_order():
    """Every automaton that can receive does, the updates in the order of the automata."""
    text = PAIR.format(kind="broadcast ", invariant="", guard="")
    assert holds(text, "E<> Sender.t and not (Left.m and Right.m)") is False
    assert holds(text, "E<> heard == 2") is True
    assert holds(text, "E<> heard == 1") is False


def test_sender_updates_first():
    """A receiver's update sees what the sender has written."""
    text = """
    chan c
    int[0,5] v
    automaton A { location a location b start a edge a -> b on c! do v = 2 }
    automaton B { location a location b start a edge a -> b on c? do v = v + 1 }
    """
    assert holds(text, "A[] (A.b imply v == 3)") is True


def test_guards_are_read_before_the_sender_writes():
    """A receiver's guard sees the variables as they were before the step."""
    text = """
    chan c
    int[0,5] v
    automaton A { location a location b start a edge a -> b on c! do v = 2 }
    automaton B { location a location b start a edge a -> b when v == 2 on c? }
    """
    assert holds(text, "E<> A.b") is False


def test_urgent_channel_stops_time():
    assert holds(PAIR.format(kind="", invariant="", guard=""), "E<> x > 0 and Sender.s") is True
    assert (
        holds(PAIR.format(kind="urgent ", invariant="", guard=""), "E<> x > 0 and Sender.s")
        is False
    )


def test_urgent_broadcast_needs_no_receiver():
    """An urgent broadcast stops time as soon as its sender can send."""
    text = """
    urgent broadcast chan c
    clock x
    automaton A { location a location b start a edge a -> b on c! }
    automaton B { location a start a edge a -> a on c? }
    """
    assert holds(text, "E<> A.a and x > 0") is False
    assert holds(text, "E<> A.b and x > 0") is True


@pytest.mark.parametrize("kind", ["urgent", "committed"])
def test_urgent_and_committed_locations_stop_time(kind):
    text = f"""
    clock x
    automaton A {{ {kind} location a location b start a edge a -> b }}
    automaton B {{ location a location b start a edge a -> b }}
    """
    assert holds(text, "E<> A.a and x > 0") is False
    assert holds(text, "E<> A.b and x > 0") is True


def test_committed_location_goes_first():
    """Only steps that leave a committed location are taken; an urgent one lets others go."""
    text = """
    automaton A {{ {kind} location a location b start a edge a -> b }}
    automaton B {{ location a location b start a edge a -> b }}
    """
    assert holds(text.format(kind="committed"), "E<> A.a and B.b") is False
    assert holds(text.format(kind="urgent"), "E<> A.a and B.b") is True


def test_target_invariant_blocks_a_step():
    """A step whose target's invariant would be false is not taken."""
    text = """
    clock x
    automaton A {
      location a
      location b invariant x <= 1
      start a
      edge a -> b when x >= 2 {update}
    }
    """
    assert holds(text.replace("{update}", ""), "E<> A.b") is False
    assert holds(text.replace("{update}", "do x = 0"), "E<> A.b") is True


def test_reset_to_a_number():
    """A clock may be set to a number, and runs on from there."""
    text = """
    clock x, y
    automaton A { location a location b start a edge a -> b when x <= 1 do x = 5 }
    """
    assert holds(text, "E<> A.b and x == 5 and y <= 1") is True
    assert holds(text, "E<> A.b and x < 5") is False
    assert holds(text, "E<> A.b and x == 7 and y > 3") is False
    assert holds(text, "E<> A.b and x == 7 and y == 3") is True


def test_strict_bounds_are_strict():
    text = """
    clock x
    automaton A { location a location b start a edge a -> b when x > 1 and x < 2 }
    """
    assert holds(text, "E<> A.b and x <= 1") is False
    assert holds(text, "E<>[<=1] A.b") is False
    assert holds(text, "E<>[<=2] A.b") is True
    assert holds(text.replace("x < 2", "x <= 1"), "E<> A.b") is False


def test_weights_below_one_make_the_likeliest_run():
    """The likeliest run avoids an improbable edge even if more steps are needed."""
    from rvmon.timed.search.meter import Policy

    network = loads_network("""
    automaton A {
      location a location b location c
      start a
      edge a -> c weight 0.1
      edge a -> b weight 0.9
      edge b -> c weight 0.5
    }
    """)
    steps = {policy: len(verify(network, "E<> A.c", policy=policy).run.steps) for policy in Policy}
    assert steps == {Policy.SHORTEST: 1, Policy.FASTEST: 1, Policy.LIKELIEST: 2}


def test_arrays_of_channels_and_variables():
    """Elements chosen by a variable are found as if they were named."""
    text = """
    chan c[3]
    int[0,2] who, list[3] = {2, 0, 1}
    automaton A { location a location b start a edge a -> b on c[list[who]]! do who = 1 }
    automaton B {
      int[0,2] got
      location a
      start a
      edge a -> a select i : int[0,2] on c[i]? do got = i
    }
    """
    assert holds(text, "A[] (A.b imply B.got == 2)") is True
    assert holds(text, "A[] (A.b imply list[who] == 0)") is True


RANKED = """
clock x
broadcast chan low, high
chan priority low < default < high
automaton A {
  location a  location b  location c  location d invariant x <= 3
  start a
  edge a -> b on low!
  edge a -> c when x >= 2 on high!
  edge a -> d when x <= 1
}
"""


@pytest.mark.parametrize(
    ("query", "answer"),
    [
        ("E<> A.b and x > 1", True),
        ("E<> A.d", True),
        # From 2 on `high` can be taken, up to 1 the edge without a channel: `low` between only.
        ("Pr[<=9; 20]([] not (A.b and x <= 1))", True),
    ],
)
def test_a_step_waits_for_those_of_higher_priority(query, answer):
    """What is possible at an instant by guards keeps back what is lower, and only then."""
    network = loads_network(RANKED)
    if query.startswith("Pr"):
        assert sample(network, asked_on(network, query)[1]).value == answer
    else:
        assert verify(network, query).holds is answer


def test_channels_count_before_automata():
    """P is above Q, and goes first unless the channel of Q's step is above steps without one."""
    text = """
    broadcast chan c
    {ranks}
    automaton Q {{ location q  location r  start q  edge q -> r {on} }}
    automaton P {{ location p  location s  start p  edge p -> s }}
    system Q < P
    """
    first = "E<> Q.r and P.p"
    assert not holds(text.format(ranks="", on=""), first)
    assert not holds(text.format(ranks="", on="on c!"), first)
    assert holds(text.format(ranks="chan priority default < c", on="on c!"), first)
    assert not holds(text.format(ranks="chan priority c < default", on="on c!"), first)


def test_what_cannot_be_entered_keeps_nothing_back():
    """A step of high priority needs the invariant behind it, now or with other values."""
    text = """
    clock x
    int[0,9] v
    broadcast chan high
    chan priority default < high
    automaton A {
      location a  location b invariant x <= v  location c
      start a
      edge a -> b on high! do v = 2
      edge a -> c
    }
    """
    run = verify(loads_network(text), "E<> A.c").run
    assert run.steps[0].window == Window(2, None, low_strict=True)


def test_what_fails_keeps_back_and_is_told():
    """A step of high priority whose update has no value is an error, not a way for others."""
    text = """
    int[0,1] v
    broadcast chan high
    chan priority default < high
    automaton A { location a  location b  start a  edge a -> a on high! do v = v + 1  edge a -> b }
    """
    with pytest.raises(ModelError, match="outside"):
        holds(text, "E<> A.b")
