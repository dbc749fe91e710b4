"""A network built from Python equals the one read from the same text."""

import pytest
from tests.tools.findings import codes_of, findings_of

from rvmon.models.language.load import NetworkBuilder, loads_network
from rvmon.models.network.expressions import LocationKind
from rvmon.models.search.verify import verify


def lamp():
    net = NetworkBuilder("lamp", "A lamp", unit=1_000_000_000)
    net.declare("chan press; int[0,3] count")
    light = net.automaton("Light", "clock y").location("off").location("on", invariant="y <= 5")
    light.edge("off", "on", sync="press?", update="y = 0", label="lit")
    light.edge("on", "off", guard="y >= 3")
    user = net.automaton("User").location("wait", kind=LocationKind.NORMAL)
    user.edge("wait", "wait", select="i : int[1,2]", guard="count < 2", sync="press!",
              update="count = i", weight=0.5)  # fmt: skip
    return net.query("E<> Light.on and count == 2", id="q", remark="it can")


@pytest.mark.slow
def test_a_built_network_equals_its_text():
    text = """
    network lamp "A lamp"
    unit 1 s
    chan press
    int[0,3] count
    automaton Light {
      clock y
      location off
      location on invariant y <= 5
      start off
      edge off -> on on press? do y = 0 as lit
      edge on -> off when y >= 3
    }
    automaton User {
      location wait
      start wait
      edge wait -> wait select i : int[1,2] when count < 2 on press! do count = i weight 0.5
    }
    query q "it can": E<> Light.on and count == 2
    """
    network = lamp().build()
    assert network == loads_network(text)
    assert verify(network, network.queries[0]).holds


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (lambda net: net.declare("clock 1"), "clock 1"),
        (lambda net: net.automaton("A").location("a", invariant="x <"), "location a invariant x <"),
        (lambda net: net.automaton("A").edge("a", "b", guard="1 +"), "edge a -> b when 1 +"),
        (lambda net: net.automaton("A").edge("a", "b", weight=2), "weight 2"),
        (lambda net: net.query("E<>"), "query: E<>"),
    ],
)
def test_a_syntax_error_shows_the_generated_line(change, line):
    net = NetworkBuilder("n")
    change(net)
    assert line in net.text
    assert findings_of(net.build)[0].spans[0].span.source.text == net.text


def test_all_unknown_names_are_reported_together():
    net = NetworkBuilder("n")
    net.automaton("A").location("a", invariant="x <= 3").edge("a", "b", sync="c!")
    assert codes_of(net.build) == ["TA002", "TA002"]
