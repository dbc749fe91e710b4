"""Draw the robot's states as a flow chart, filled by the share of statements that ran."""

from __future__ import annotations

import xml.etree.ElementTree as ET

from handover.collector.code import COMMON, TRANSITIONS
from handover.robot.handover import STATES
from rvmon.cdv.campaign_summary import BlockCoverage, StrategySummary, Transition
from rvmon.report.html import e
from rvmon.texts import percent_text

LEFT, BOX_WIDTH, BOX_HEIGHT, PITCH = 34, 200, 34, 54
LANE = 13
"""Distance between two lines that bypass other states on the way to the last one."""

RIGHT = LEFT + BOX_WIDTH
CENTRE = LEFT + BOX_WIDTH / 2


def flow_chart(figures: StrategySummary) -> ET.Element:
    """Draw the chart of one strategy.

    The number beside a line is how many tests took that transition; it is dashed if none did.
    """
    exits = [
        (source, target)
        for source, target in TRANSITIONS
        if target == STATES[-1] and _row(source) < len(STATES) - 2
    ]
    width = RIGHT + LANE * (len(exits) + 1) + 14
    height = PITCH * (len(STATES) + 1) + 6
    chart = e(
        "svg",
        {"viewBox": f"0 0 {width} {height}", "class": "flow", "role": "img"},
        e("title", None, "Statement coverage by state of the robot"),
    )
    for transition in TRANSITIONS:
        if transition in exits:
            lane = len(exits) - exits.index(transition)
            chart.append(_exit(transition, lane, figures))
        elif transition[0] == transition[1]:
            chart.append(_loop(transition, figures))
        else:
            chart.append(_step(transition, figures))
    for state in STATES:
        chart.append(_box(state, state, _top(state), figures.statements[state]))
    shared = figures.statements[COMMON]
    chart.append(_box("shared code", COMMON, PITCH * len(STATES) + 8, shared))
    return chart


def _box(label: str, state: str, top: float, coverage: BlockCoverage) -> ET.Element:
    share = coverage.covered / coverage.statements if coverage.statements else 1.0
    kind = "state shared" if state == COMMON else "state"
    if coverage.covered == 0:
        kind += " never"
    missing = ", ".join(coverage.missing)
    share_text = f"{coverage.covered} of {coverage.statements} statements ran"
    frame = {"x": LEFT, "y": top, "width": BOX_WIDTH, "height": BOX_HEIGHT, "rx": 6}
    return e(
        "g",
        {"class": kind},
        e("title", None, f"{share_text}; not run: lines {missing}" if missing else share_text),
        e("rect", {"class": "frame", **frame}),
        e("rect", {"class": "filled", **frame, "width": f"{BOX_WIDTH * share:.1f}"}),
        e("rect", {"class": "edge", **frame}),
        e("text", {"x": LEFT + 9, "y": top + 22}, label),
        e(
            "text",
            {"x": RIGHT - 9, "y": top + 22, "class": "share"},
            percent_text(coverage.covered, coverage.statements),
        ),
    )


def _step(transition: Transition, figures: StrategySummary) -> ET.Element:
    start, end = _top(transition[0]) + BOX_HEIGHT, _top(transition[1])
    line = f"M{CENTRE} {start}V{end - 5}"
    tip = f"M{CENTRE} {end}l-4 -7h8z"
    return _edge(transition, line, tip, (CENTRE + 7, start + 14), figures)


def _loop(transition: Transition, figures: StrategySummary) -> ET.Element:
    """A line from a state's left side back to it."""
    top = _top(transition[0])
    line = f"M{LEFT} {top + 25}h-6q-8 0 -8 -8t8 -8h2"
    tip = f"M{LEFT} {top + 9}l-7 -4v8z"
    return _edge(transition, line, tip, (LEFT - 18, top + 21), figures, anchor="end")


def _exit(transition: Transition, lane: int, figures: StrategySummary) -> ET.Element:
    """A line past all other states to the last one; the line of the first state is outermost."""
    start = _top(transition[0]) + BOX_HEIGHT / 2
    end = _top(transition[1]) + BOX_HEIGHT / 2
    x = RIGHT + LANE * lane + 4
    line = f"M{RIGHT} {start}H{x - 6}q6 0 6 6V{end - 6}q0 6 -6 6H{RIGHT + 5}"
    tip = f"M{RIGHT} {end}l7 -4v8z"
    return _edge(transition, line, tip, (RIGHT + 4, start - 4), figures)


def _edge(
    transition: Transition,
    line: str,
    tip: str,
    label: tuple[float, float],
    figures: StrategySummary,
    *,
    anchor: str = "start",
) -> ET.Element:
    tests = figures.transitions.get(transition, 0)
    source, target = transition
    edge = e(
        "g",
        {"class": "edge taken" if tests else "edge"},
        e("title", None, f"{source} → {target}: {tests} of {figures.tests} tests"),
        e("path", {"d": line}),
        e("path", {"class": "tip", "d": tip}),
    )
    if tests:
        x, y = label
        edge.append(e("text", {"x": x, "y": y, "text-anchor": anchor}, str(tests)))
    return edge


def _row(state: str) -> int:
    return STATES.index(state)


def _top(state: str) -> float:
    return 4 + PITCH * _row(state)
