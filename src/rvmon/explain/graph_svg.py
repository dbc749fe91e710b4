"""An automaton as SVG: places in columns by their distance from the trigger, numbered edges."""

from __future__ import annotations

import textwrap
import xml.etree.ElementTree as ET
from collections.abc import Iterable, Mapping, Sequence
from math import dist

from rvmon.diagnostics.shown import shown
from rvmon.explain.graph import ENDS, Edge, Graph, Place, label_of

COLUMN, ROW, BOX, HALF = 230, 110, 150, 28
MARGIN, LINE, LOOP = 30, 18, 46
WRAP = 22
"""Characters in a line of a box."""
BENDS = tuple(ROW * share for share in (0.55, -0.55, 1.1, 1.6, 2.2, 2.8))
"""How far an edge past a column swings down; the first that no box hides is taken."""
FONT = "ui-sans-serif, system-ui, sans-serif"
Point = tuple[float, float]
Curve = tuple[Point, Point, Point]
STROKES = {"P": "#1a7f4b", "F": "#c4302b"}


def graph_svg(graph: Graph, title: str) -> str:
    """The automaton as an SVG document; below it what the numbers on its edges stand for."""
    at = _positions(graph)
    edges = list(_merged(graph).items())
    width = max(max(x for x, _ in at.values()) + BOX + MARGIN, 560)
    drawn = [_edge(at, ends) for ends, _ in edges]
    lowest = max(_at(curve, share / 10)[1] for _, curve in drawn for share in range(11))
    height = max(max(y for _, y in at.values()) + HALF, lowest) + MARGIN
    legend = [
        line
        for number, (_, texts) in enumerate(edges, 1)
        for line in _legend(str(number), "  or  ".join(texts))
    ]
    for place in graph.places:
        if _shown(place)[-1:] != textwrap.wrap(place.owed, WRAP)[-1:]:
            legend += _legend(place.name, f"owed: {place.owed}")
    svg = ET.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "viewBox": f"0 0 {width} {height + LINE * (len(legend) + 2):g}",
            "width": str(width),
            "font-family": FONT,
            "font-size": "12",
            "role": "img",
        },
    )
    ET.SubElement(svg, "title").text = shown(f"Automaton of {title}")
    _background(svg)
    badges: list[Point] = []
    for path, curve in drawn:
        look = {"fill": "none", "stroke": "#555", "stroke-width": "1.3"}
        ET.SubElement(svg, "path", {"d": path, **look, "marker-end": "url(#arrow)"})
        badges.append(_free_point(curve, badges, at.values()))
    for number, badge in enumerate(badges, 1):
        _badge(svg, badge, number)
    for place in graph.places:
        _place(svg, place, at[place.name])
    for row, line in enumerate(map(shown, legend)):
        y = height + LINE * (row + 1)
        ET.SubElement(svg, "text", {"x": str(MARGIN), "y": f"{y:g}", "fill": "#222"}).text = shown(
            line
        )
    ET.indent(svg)
    return ET.tostring(svg, encoding="unicode") + "\n"


def _positions(graph: Graph) -> Mapping[str, tuple[int, int]]:
    """The left edge and the middle height of each place."""
    start = graph.places[0].name
    layer = {start: 0}
    waiting = [start]
    for name in waiting:
        for edge in graph.edges:
            if edge.source == name and edge.target not in layer and edge.target not in ENDS:
                layer[edge.target] = layer[name] + 1
                waiting.append(edge.target)
    last = max(layer.values()) + 1
    used: dict[int, int] = {}
    at = {}
    for place in graph.places:
        column = last if place.name in ENDS else layer.get(place.name, 1)
        row = used.get(column, 0)
        used[column] = row + 1
        at[place.name] = (MARGIN + column * COLUMN, MARGIN + LOOP + HALF + row * ROW)
    return at


def _merged(graph: Graph) -> Mapping[tuple[str, str], list[str]]:
    """The conditions of all edges between two places."""
    found: dict[tuple[str, str], list[str]] = {}
    for edge in graph.edges:
        found.setdefault((edge.source, edge.target), []).append(_condition(edge))
    return found


def _condition(edge: Edge) -> str:
    return label_of(edge) + (f"  ({edge.sets})" if edge.sets else "")


def _legend(sign: str, text: str) -> list[str]:
    lines = textwrap.wrap(f"{sign}  {text}", 84, subsequent_indent="     ")
    return [line.replace("  ", "\u00a0\u00a0") for line in lines]


def _background(svg: ET.Element) -> None:
    ET.SubElement(svg, "rect", {"width": "100%", "height": "100%", "fill": "white"})
    marker = {"id": "arrow", "viewBox": "0 0 8 8", "refX": "7", "refY": "4", "orient": "auto"}
    definitions = ET.SubElement(svg, "defs")
    head = ET.SubElement(definitions, "marker", {**marker, "markerWidth": "8", "markerHeight": "8"})
    ET.SubElement(head, "path", {"d": "M0 0 L8 4 L0 8 z", "fill": "#555"})


def _place(svg: ET.Element, place: Place, at: tuple[int, int]) -> None:
    x, y = at
    end = place.name in ENDS
    box = {"x": str(x), "y": str(y - HALF), "width": str(HALF * 2 if end else BOX)}
    stroke = STROKES.get(place.name, "#333")
    look = {"height": str(HALF * 2), "rx": str(HALF if end else 8), "fill": "#f7f7f7"}
    ET.SubElement(svg, "rect", {**box, **look, "stroke": stroke, "stroke-width": "1.5"})
    lines = [ENDS.get(place.name, place.name)]
    lines += _shown(place)
    middle = x + (HALF if end else BOX // 2)
    for row, line in enumerate(lines):
        height = y + 4 + (row - (len(lines) - 1) / 2) * 15
        style = {"font-weight": "bold"} if row == 0 else {"font-size": "11"}
        fill = stroke if row == 0 else "#444"
        place_of = {"x": str(middle), "y": f"{height:g}", "text-anchor": "middle", "fill": fill}
        text = ET.SubElement(svg, "text", {**place_of, **style})
        text.text = line
        if row == 0 and not end:
            ET.SubElement(text, "title").text = place.owed


def _shown(place: Place) -> list[str]:
    """What is owed at a place, as far as its box has room."""
    if place.name in ENDS:
        return []
    return textwrap.wrap(place.owed, WRAP, max_lines=2, placeholder=" …")


def _edge(at: Mapping[str, tuple[int, int]], ends: tuple[str, str]) -> tuple[str, Curve]:
    """The path of an edge, and a quadratic curve on or near it for its number."""
    source, target = ends
    (x1, y1), (x2, y2) = at[source], at[target]
    if source == target:
        middle, top = x1 + BOX / 2, y1 - HALF
        path = f"M{middle - 18:g} {top} C{middle - 30:g} {top - LOOP} "
        path += f"{middle + 30:g} {top - LOOP} {middle + 18:g} {top}"
        return path, ((middle - 18, top - 15), (middle, top - 1.2 * LOOP), (middle + 18, top - 15))
    curve: Curve
    if x1 == x2:
        down = 1 if y2 > y1 else -1
        x = x1 + BOX / 2 + 30 * down
        curve = ((x, y1 + HALF * down), (x, (y1 + y2) / 2), (x, y2 - HALF * down))
    else:
        ahead = x2 > x1
        left, right = (x1 + BOX, x2) if ahead else (x1, x2 + BOX)
        lift = 14 if ahead else -14
        middle = (left + right) / 2

        def bent(bend: float) -> Curve:
            return (left, y1 + lift), (middle, (y1 + y2) / 2 + bend + lift), (right, y2 + lift / 2)

        others = [corner for name, corner in at.items() if name not in ends]
        bends = BENDS if abs(x2 - x1) > COLUMN else (0.0,)
        curve = min(map(bent, bends), key=lambda tried: _hidden(tried, others))
    (ax, ay), (bx, by), (cx, cy) = curve
    return f"M{ax:g} {ay:g} Q{bx:g} {by:g} {cx:g} {cy:g}", curve


def _hidden(curve: Curve, boxes: Sequence[tuple[int, int]]) -> int:
    """How much of a curve, in twentieths, lies behind boxes."""
    return sum(_is_behind(_at(curve, share / 20), boxes, 0) for share in range(1, 20))


def _is_behind(point: Point, boxes: Iterable[tuple[int, int]], margin: float) -> bool:
    x, y = point
    return any(
        left - margin < x < left + BOX + margin and abs(y - middle) < HALF + margin
        for left, middle in boxes
    )


def _free_point(curve: Curve, taken: Sequence[Point], boxes: Iterable[tuple[int, int]]) -> Point:
    """A point of the curve, near its middle, away from those taken and from the boxes."""
    corners = list(boxes)

    def room(point: Point) -> float:
        if _is_behind(point, corners, 9):
            return 0.0
        return min((20.0, *(dist(point, other) for other in taken)))

    shares = (0.5, 0.4, 0.6, 0.3, 0.7, 0.22, 0.78, 0.14, 0.86)
    return max((_at(curve, share) for share in shares), key=room)


def _at(curve: Curve, share: float) -> Point:
    (ax, ay), (bx, by), (cx, cy) = curve
    one, two, three = (1 - share) ** 2, 2 * share * (1 - share), share**2
    return one * ax + two * bx + three * cx, one * ay + two * by + three * cy


def _badge(svg: ET.Element, at: Point, number: int) -> None:
    x, y = at
    circle = {"cx": f"{x:g}", "cy": f"{y:g}", "r": "9", "fill": "white", "stroke": "#888"}
    ET.SubElement(svg, "circle", circle)
    place = {"x": f"{x:g}", "y": f"{y + 4:g}", "text-anchor": "middle", "font-size": "11"}
    ET.SubElement(svg, "text", place).text = str(number)
