"""Draw the handover with its monitors: `python docs/images/make_animation.py` writes handover.svg.

Two directed tests are played and judged by `specs/handover.rv`; what moves and lights up in the
picture is what the simulation recorded and the monitors reported. It needs `rvmon[handover]`.
"""

from __future__ import annotations

import math
import sys
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import rvmon
from handover.checker import spec_path
from handover.driver import run_test
from handover.driver.play import SampleValues
from handover.generator.abstract_test import directed
from rvmon.report.html import e
from rvmon.report.run_html import UNITS, scene_svg
from rvmon.report.wording import MARKS, verdict_colours
from rvmon.trace.time import TICKS_PER_SECOND

TESTS = ("released", "mutant-releases-anyway")
SHOWN = ("informed", "grip_closed", "sensed", "decided", "released")
"""Events whose names are shown in the scene."""

FIRST_S, LAST_S = 8.0, 30.0
SPEED = 2.0
HOLD_S = 3.0
"""Seconds for which the end is shown before the animation restarts."""

LENGTH_S = (LAST_S - FIRST_S) / SPEED + HOLD_S
FRAME_S = 0.1
"""Time between two frames; no frames are made while nothing moves."""

PANEL, SCENE_HEIGHT, ROW = 440, 256, 44
STYLE = """
svg{--page:#fbfbfa;--card:#fff;--ink:#1c1f23;--soft:#5b636d;--line:#e3e4e6;--fill:#eef0f2;
--accent:#2f6fb0;--open:#b7791f;font-family:system-ui,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
@media(prefers-color-scheme:dark){svg{--page:#0f1215;--card:#171b20;--ink:#e6e8ea;--soft:#9aa4ae;
--line:#2a3037;--fill:#20262d;--accent:#7db4ea;--open:#e3a83b}}
text{fill:var(--ink);font-size:12.5px}
.spec{font:11px ui-monospace,"DejaVu Sans Mono",Menlo,Consolas,monospace}
.message{font:600 13px ui-monospace,"DejaVu Sans Mono",Menlo,Consolas,monospace;fill:var(--accent)}
.body{fill:var(--soft);stroke:var(--soft);stroke-width:4;stroke-linejoin:round;stroke-linecap:round}
.body.link{stroke:var(--accent);fill:none}.body.gripper{fill:var(--accent);stroke:var(--accent)}
.body.piece{fill:var(--open);stroke:var(--open)}.body.person{fill:var(--ink);stroke:var(--ink)}
.body.gaze{fill:var(--ink);stroke:none;opacity:.12}.body.ground{fill:var(--line);stroke:var(--line)}
.cover{fill:var(--card)}.waiting{fill:var(--open)}.lamp{stroke:var(--line);stroke-width:1.5}
.badge{font-weight:700;text-anchor:end}.axis{fill:var(--soft);font-size:11px;text-anchor:middle}
"""


@dataclass(frozen=True)
class Lamp:
    """One requirement of a run.

    Attributes:
        name: its id.
        lines: its lines in the file.
        opened: the start of its attempt, seconds; `None` if it was not triggered.
        decided: the instant of its decision, seconds; the end of the picture if it never was.
        verdict: of the whole run.
    """

    name: str
    lines: tuple[str, ...]
    opened: float | None
    decided: float
    verdict: rvmon.Verdict


class Sheet:
    """The CSS animations of one picture; with reduced motion only the end is shown."""

    def __init__(self) -> None:
        self._rules: list[str] = []

    def animate(self, frames: Iterable[tuple[float, str]], *, steps: bool = False) -> str:
        """The CSS class of elements with these declarations at these seconds of the run."""
        name = f"a{len(self._rules)}"
        keyed = list(frames)
        keys = "".join(f"{_percent(t)}{{{style}}}" for t, style in keyed)
        timing = "step-end" if steps else "linear"
        self._rules.append(
            f"@keyframes {name}{{{keys}100%{{{keyed[-1][1]}}}}}"
            f".{name}{{{keyed[-1][1]};animation:{name} {LENGTH_S:g}s {timing} infinite}}"
        )
        return name

    def text(self) -> str:
        """The style sheet."""
        still = "@media(prefers-reduced-motion:reduce){*{animation:none!important}}"
        return verdict_colours() + STYLE + "".join(self._rules) + still


def main(target: Path) -> None:
    """Play both tests and write the picture."""
    sheet = Sheet()
    panels = [_panel(sheet, name, 10 + 450 * at) for at, name in enumerate(TESTS)]
    width, height = 2 * PANEL + 30, SCENE_HEIGHT + 5 * ROW + 84
    picture = e(
        "svg",
        {"xmlns": "http://www.w3.org/2000/svg", "viewBox": f"0 0 {width} {height}", "role": "img"},
        e("title", None, "A handover by two robots, and the verdicts of five requirements"),
        e("style", None, sheet.text()),
        e("rect", {"width": width, "height": height, "style": "fill:var(--page)"}),
        *panels,
    )
    target.write_text(ET.tostring(picture, encoding="unicode") + "\n", encoding="utf-8")


def _panel(sheet: Sheet, name: str, x: int) -> ET.Element:
    test = next(test for test in directed() if test.name == name)
    run = run_test(test, films=True)
    lamps = _judged(run.samples, run.simulated_s)
    events = [
        (t / TICKS_PER_SECOND, event)
        for t, values in run.samples
        for event in SHOWN
        if values.get(event)
    ]
    scene = run.scene
    drawing = scene_svg(scene, 0)
    for key, value in {"x": 0, "y": 34, "width": PANEL, "height": SCENE_HEIGHT}.items():
        drawing.set(key, str(value))
    for group in drawing.iter("g"):
        if (body := group.attrib.pop("data-body", None)) is not None:
            del group.attrib["transform"]
            moves = sheet.animate(_moves(scene.frames, int(body)))
            group.set("class", f"{group.get('class')} {moves}")
    top = SCENE_HEIGHT + 44
    return e(
        "svg",
        {"x": x, "y": 10, "width": PANEL, "height": top + 5 * ROW + 20},
        e("rect", {"width": PANEL, "height": top + 5 * ROW + 20, "rx": 8, "class": "cover"}),
        e("text", {"x": 14, "y": 24}, test.text),
        drawing,
        *_messages(sheet, events),
        *(_row(sheet, lamp, top + ROW * at) for at, lamp in enumerate(lamps)),
        *_cursor(sheet, top),
    )


def _judged(samples: Iterable[tuple[int, SampleValues]], end_s: float) -> list[Lamp]:
    path = spec_path("correct").with_name("handover.rv")
    text = path.read_text(encoding="utf-8")
    spec = rvmon.load(path)
    names = {*spec.schema.signals, *spec.schema.events}
    trace = (
        (t / TICKS_PER_SECOND, {name: value for name, value in values.items() if name in names})
        for t, values in samples
    )
    report = spec.evaluate(trace, until=end_s)
    firsts = {one.requirement: one for one in reversed(report.attempts)}
    lamps = []
    for name, requirement in spec.requirements.items():
        written = text[requirement.span.start : requirement.span.end].splitlines()
        lines = [line.strip() for line in written if line.strip().startswith(("upon", "then"))]
        first = firsts.get(name)
        opened = None if first is None else first.triggered / TICKS_PER_SECOND
        decided = LAST_S
        if first is not None and first.decided is not None:
            decided = first.decided / TICKS_PER_SECOND
        lamps.append(Lamp(name, tuple(lines), opened, decided, report.verdicts[name]))
    return lamps


def _row(sheet: Sheet, lamp: Lamp, y: int) -> ET.Element:
    mark, colour = MARKS[lamp.verdict], f"fill:var(--{lamp.verdict.value})"
    waits = [(FIRST_S, "fill:var(--fill)"), (lamp.decided, colour)]
    bar = []
    if lamp.opened is not None:
        waits.insert(1, (lamp.opened, "fill:var(--open)"))
        start, stop = _across(lamp.opened), _across(lamp.decided)
        width = max(stop - start, 1)
        bar = [
            e("rect", {"x": start, "y": 35, "width": width, "height": 4, "class": "waiting"}),
            e("circle", {"cx": stop, "cy": 37, "r": 4, "style": colour}),
        ]
    shows = sheet.animate([(FIRST_S, "opacity:0"), (lamp.decided, "opacity:1")], steps=True)
    badge = f"{lamp.verdict.value} {mark.sign}"
    return e(
        "g",
        {"transform": f"translate(0 {y})"},
        e(
            "circle",
            {"cx": 22, "cy": 14, "r": 9, "class": f"lamp {sheet.animate(waits, steps=True)}"},
        ),
        e("text", {"x": 42, "y": 19, "style": "font-weight:600"}, lamp.name),
        *(
            e("text", {"x": 72, "y": 11 + 15 * at, "class": "spec"}, line)
            for at, line in enumerate(lamp.lines)
        ),
        e("text", {"x": PANEL - 14, "y": 12, "class": f"badge {shows}", "style": colour}, badge),
        *bar,
    )


def _messages(sheet: Sheet, events: list[tuple[float, str]]) -> Iterator[ET.Element]:
    """The text of the robot's last message."""
    ends = [t for t, _ in events[1:]] + [LAST_S + HOLD_S * SPEED]
    for (t, event), end in zip(events, ends, strict=True):
        frames = [(FIRST_S, "opacity:0"), (t, "opacity:1"), (end, "opacity:0")]
        shows = sheet.animate(frames if end <= LAST_S else frames[:2], steps=True)
        yield e("text", {"x": 14, "y": 54, "class": f"message {shows}"}, event)


def _cursor(sheet: Sheet, top: int) -> Iterator[ET.Element]:
    """A cover over the future part of the tracks, up to the instant shown."""
    way = _across(LAST_S) - _across(FIRST_S)
    frames = [(FIRST_S, "transform:translate(0px)"), (LAST_S, f"transform:translate({way}px)")]
    moves = sheet.animate(frames)
    for at in range(5):
        yield e(
            "rect",
            {"x": _across(FIRST_S), "y": top + ROW * at + 32, "width": way + 20, "height": 10}
            | {"class": f"cover {moves}"},
        )
    for second in range(10, 30, 5):
        x = _across(second)
        yield e("text", {"x": x, "y": top + 5 * ROW + 12, "class": "axis"}, f"{second} s")


def _moves(
    frames: Sequence[tuple[int, tuple[float, ...]]], body: int
) -> Iterator[tuple[float, str]]:
    """The positions of a body over time, without instants at which it does not move."""
    at, shown = FIRST_S, ""
    for ticks, pose in frames:
        x, z, angle = pose[3 * body : 3 * body + 3]
        style = (
            f"transform:translate({x * UNITS:.0f}px,{-z * UNITS:.0f}px)"
            f"rotate({-math.degrees(angle):.1f}deg)"
        )
        t = ticks / TICKS_PER_SECOND
        if FIRST_S < t <= LAST_S and style != shown:
            yield max(at, t - FRAME_S), shown
            yield t, style
            at = t
        shown = style


def _across(t: float) -> int:
    """The x coordinate of an instant on the tracks of the requirements."""
    share = (min(max(t, FIRST_S), LAST_S) - FIRST_S) / (LAST_S - FIRST_S)
    return round(14 + share * (PANEL - 28))


def _percent(t: float) -> str:
    return f"{100 * max(t - FIRST_S, 0) / SPEED / LENGTH_S:.2f}%"


if __name__ == "__main__":
    main(Path(*sys.argv[1:2] or [Path(__file__).with_name("handover.svg")]))
