"""The rules for steps, each shown by what a small network can and cannot reach."""

import pytest
from tests.tools.each import each

from rvmon.errors import ModelError
from rvmon.models.language.elaborate import query_on
from rvmon.models.language.load import loads_network
from rvmon.models.runs import Window
from rvmon.models.runs.statistics import sample
from rvmon.models.search.verify import verify

PAIR = """
{kind}chan c
clock x
int[0,3] heard
automaton Sender {{ location s location t start s edge s -> t on c! }}
automaton Left {{ location l location m start l edge l -> m on c? do heard = heard + 1 }}
automaton Right {{ location l location m start l edge l -> m on c? do heard = heard * 2 }}
"""
TWO = """
clock x
automaton A {{ {kind} location a location b start a edge a -> b }}
automaton B {{ location a location b start a edge a -> b }}
"""
WRITTEN = """
chan c
int[0,5] v
automaton A {{ location a location b start a edge a -> b on c! do v = 2 }}
automaton B {{ location a location b start a edge a -> b {receives} }}
"""
BLOCKED = """
clock x
automaton A {{
  location a
  location b invariant x <= 1
  start a
  edge a -> b when x >= 2 {update}
}}
"""
RADIO = """
urgent broadcast chan c
clock x
automaton A { location a location b start a edge a -> b on c! }
automaton B { location a start a edge a -> a on c? }
"""
ARRAYS = """
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
RANKS = """
broadcast chan c
{ranks}
automaton Q {{ location q  location r  start q  edge q -> r {on} }}
automaton P {{ location p  location s  start p  edge p -> s }}
system Q < P
"""

RULES = {
    "a binary channel has one receiver, never both": (
        PAIR.format(kind=""),
        {"E<> Left.m": True, "E<> Right.m": True, "E<> Left.m and Right.m": False},
    ),
    "a broadcast reaches all that can receive, in the order of the automata": (
        PAIR.format(kind="broadcast "),
        {
            "E<> Sender.t and not (Left.m and Right.m)": False,
            "E<> heard == 2": True,
            "E<> heard == 1": False,
        },
    ),
    "a receiver's update sees what the sender has written": (
        WRITTEN.format(receives="on c? do v = v + 1"),
        {"A[] (A.b imply v == 3)": True},
    ),
    "a receiver's guard sees the variables as they were before the step": (
        WRITTEN.format(receives="when v == 2 on c?"),
        {"E<> A.b": False},
    ),
    "a ready channel lets time pass": (
        PAIR.format(kind=""),
        {"E<> x > 0 and Sender.s": True},
    ),
    "an urgent channel does not": (
        PAIR.format(kind="urgent "),
        {"E<> x > 0 and Sender.s": False},
    ),
    "an urgent broadcast stops time as soon as its sender can send": (
        RADIO,
        {"E<> A.a and x > 0": False, "E<> A.b and x > 0": True},
    ),
    "an urgent location stops time, but no other steps": (
        TWO.format(kind="urgent"),
        {"E<> A.a and x > 0": False, "E<> A.b and x > 0": True, "E<> A.a and B.b": True},
    ),
    "a committed location stops time and goes first": (
        TWO.format(kind="committed"),
        {"E<> A.a and x > 0": False, "E<> A.b and x > 0": True, "E<> A.a and B.b": False},
    ),
    "a step whose target's invariant would be false is not taken": (
        BLOCKED.format(update=""),
        {"E<> A.b": False},
    ),
    "the invariant is evaluated after the update": (
        BLOCKED.format(update="do x = 0"),
        {"E<> A.b": True},
    ),
    "a variable may select a channel or an element": (
        ARRAYS,
        {"A[] (A.b imply B.got == 2)": True, "A[] (A.b imply list[who] == 0)": True},
    ),
    **{
        f"P outranks Q unless Q's channel outranks steps without one: {ranks} {on}": (
            RANKS.format(ranks=ranks, on=on),
            {"E<> Q.r and P.p": first},
        )
        for ranks, on, first in (
            ("", "", False),
            ("", "on c!", False),
            ("chan priority default < c", "on c!", True),
            ("chan priority c < default", "on c!", False),
        )
    },
}


@each("rule", RULES)
def test_steps_follow_the_rule(rule):
    text, answers = RULES[rule]
    network = loads_network(text)
    assert {query: verify(network, query).holds for query in answers} == answers


def test_a_random_run_leaves_a_committed_location():
    network = loads_network(TWO.format(kind="committed"))
    leaves = query_on(network, "Pr[<=9; 20](<> A.b)")[1]
    assert sample(network, leaves).value == 1


def test_a_step_is_blocked_only_while_one_of_higher_priority_is_enabled():
    network = loads_network("""
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
    """)
    assert verify(network, "E<> A.b and x > 1").holds
    assert verify(network, "E<> A.d").holds
    # The edge without a channel blocks `low` up to 1, and `high` blocks it from 2.
    between = query_on(network, "Pr[<=9; 20]([] not (A.b and x <= 1))")[1]
    assert sample(network, between).value == 1


def test_a_step_whose_target_invariant_is_false_blocks_no_other():
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


def test_a_failing_update_of_high_priority_is_an_error_and_unblocks_nothing():
    text = """
    int[0,1] v
    broadcast chan high
    chan priority default < high
    automaton A { location a  location b  start a  edge a -> a on high! do v = v + 1  edge a -> b }
    """
    with pytest.raises(ModelError, match="outside"):
        verify(loads_network(text), "E<> A.b")
