"""The interface of a system under test: its measured code, playing a test, judging its samples."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, TypeVar

from rvmon.cdv.test import Test
from rvmon.coverage import Hit, Hits, illegal
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.report.tracks import Scene
from rvmon.trace.sample import Value
from rvmon.verdicts.report import Report, report_of
from rvmon.verdicts.run_coverage import IllegalHit

if TYPE_CHECKING:
    from rvmon.coverage.monitor import SpecCoverage
    from rvmon.language.checked.specification import CheckedSpec
    from rvmon.session import Spec


COMMON = "common"
"""The block of all functions that no other block names."""


@dataclass(frozen=True, slots=True)
class Block:
    """Lines of a file that belong together, such as those of a state of the robot.

    Attributes:
        name: unique in a campaign.
        path: of the source file.
        lines: line numbers from 1; lines without a statement are ignored.
    """

    name: str
    path: str
    lines: frozenset[int]


@dataclass(frozen=True, slots=True)
class Code:
    """The code whose coverage is measured.

    Attributes:
        blocks: in the order in which they are shown.
        branches: whether branches are measured as well as statements.
        marked: measure only what runs within `observer.code()`, so that a simulation around the
            code under test is not slowed down; otherwise all of `play` is measured.
        kind: the word for a block, in the singular.
        constants: by file path, names of module-level constants. They are mutated like functions,
            but not measured.
        equivalent: a TOML file of mutants that do not change the behaviour, each with an argument.
    """

    blocks: Sequence[Block]
    branches: bool = True
    marked: bool = False
    kind: str = "block"
    constants: Mapping[str, Sequence[str]] = field(default_factory=dict)
    equivalent: str | Path | None = None

    def __post_init__(self) -> None:
        """Check that block names are unique.

        Raises:
            RvmonError: two blocks have the same name, for example functions of two files.
        """
        named = {block.name: block for block in self.blocks}
        for block in self.blocks:
            if named[block.name] is not block:
                raise RvmonError(
                    f"two blocks are called `{block.name}`, in {block.path} and in "
                    f"{named[block.name].path}: rename one"
                )


def blocks_of(path: str | Path, names: Mapping[str, str] | None = None) -> tuple[Block, ...]:
    """The functions of a file as blocks, without their `def` lines.

    Args:
        path: of a Python file, which is parsed but not run.
        names: the block of each function, as in `{"Base.brake": "braking"}`. Functions may share a
            block; functions left out belong to `common`. Default: one block per function.

    Raises:
        UnknownNameError: the file has no such function.
        RvmonError: the file cannot be read, or is not Python.
    """
    try:
        tree = ast.parse(Path(path).read_bytes(), filename=str(path))
    except OSError as error:
        raise RvmonError(f"{path}: {error.strerror}") from None
    except (SyntaxError, ValueError) as error:
        raise RvmonError(f"{path}: not Python: {error}") from None
    functions = dict(_functions(tree, ""))
    for name in names or ():
        if name not in functions:
            raise UnknownNameError(
                f"{path}: no function `{name}`: there are {', '.join(functions)}"
            )
    blocks: dict[str, set[int]] = {name: set() for name in (names or {}).values()}
    for name, lines in functions.items():
        blocks.setdefault(name if names is None else names.get(name, COMMON), set()).update(lines)
    # Not resolved: Python loads modules under this path, even if it is a link.
    file = str(Path(path).absolute())
    return tuple(Block(name, file, frozenset(lines)) for name, lines in blocks.items())


def _functions(tree: ast.AST, prefix: str) -> Iterator[tuple[str, range]]:
    """Functions and methods by qualified name; a nested function belongs to the outer one."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            assert node.end_lineno is not None, "parsed from a text"
            yield f"{prefix}{node.name}", range(node.lineno + 1, node.end_lineno + 1)
        elif isinstance(node, ast.ClassDef):
            yield from _functions(node, f"{prefix}{node.name}.")
        elif not isinstance(node, ast.expr):
            yield from _functions(node, prefix)


Values = Mapping[str, Value]
"""Signal updates and events at an instant, by name; an event is `True`, an unknown value `None`."""

Taker = Callable[[int, Values], None]
"""Takes one sample: its time in ns, and its values."""


@dataclass(frozen=True, slots=True)
class Run:
    """What a system returns at the end of a run; it has passed the samples to the observer.

    Attributes:
        end_ns: the instant up to which the run is judged, not before its last sample.
        states: `(t_ns, state)` for each entry of a state of the system, re-entries included.
        error: the exception of the code under test, as text, if it crashed.
        figures: numbers by name, such as seconds of physics; a campaign adds them up over its runs.
        facts: pairs of name and value that are shown on the page of the run.
        scene: the film of the run, if `Observer.wants_scene`.
    """

    end_ns: int
    states: Sequence[tuple[int, str]] = ()
    error: str | None = None
    figures: Mapping[str, float] = field(default_factory=dict)
    facts: Sequence[tuple[str, str]] = ()
    scene: Scene | None = None

    def __post_init__(self) -> None:
        """Check the types here, so that a mistake is reported in the test that makes it.

        Raises:
            TypeError: `end_ns` is not an int, a figure is not a number, or a state is not a pair.
        """
        if type(self.end_ns) is not int:
            raise TypeError(f"end_ns must be an int, not {self.end_ns!r}")
        for name, figure in self.figures.items():
            if not isinstance(figure, int | float):
                raise TypeError(f"figure `{name}` must be a number, not {figure!r}")
        for entry in self.states:
            if [*map(type, entry)] != [int, str]:
                raise TypeError(f"a state must be given as (ns, name), not {entry!r}")


class Observer:
    """Receives each sample from a system while it plays: `observer(t_ns, values)`.

    Args:
        takers: functions that get each sample.
        code: the context in which code is measured.
        wants_scene: whether the run should have a scene, for its page.

    Attributes:
        last_ns: instant of the latest sample; 0 before the first.
        wants_scene: see `Args`.
    """

    def __init__(
        self,
        takers: Sequence[Taker],
        *,
        code: AbstractContextManager[object] | None = None,
        wants_scene: bool = False,
    ) -> None:
        self._takers = takers
        self._code = nullcontext() if code is None else code
        self.last_ns = 0
        self.wants_scene = wants_scene

    def __call__(self, t_ns: int, values: Values) -> None:
        """Take one whole sample, later than the previous one.

        Args:
            t_ns: its instant.
            values: signal updates and events; names that the requirements do not declare are
                ignored. An event that occurred several times is a tuple of its payloads, `({}, {})`
                if it has no fields.
        """
        for take in self._takers:
            take(t_ns, values)
        self.last_ns = t_ns

    def code(self) -> AbstractContextManager[object]:
        """The context in which to run the code under test, so that `Code.marked` measures only it.

        It can be entered repeatedly, but not nested.
        """
        return self._code


_Test = TypeVar("_Test", bound=Test, contravariant=True)


class System(Protocol[_Test]):
    """A robot in its world or its simulator. One object plays many tests, one after the other.

    The same test must give the same run, whatever was played before. Start external programs, such
    as a simulator, with `rvmon.execute.run_command`: they then end with this process, which is
    killed if a test takes too long.
    """

    def play(self, test: _Test, observer: Observer, /) -> Run:
        """Play a test from start to end.

        Args:
            test: everything that the run depends on.
            observer: call it with each sample.
        """
        ...


class Checker:
    """Judges one test after the other: `start`, `observe` each sample, `finish`.

    Names that a specification does not declare are ignored.

    Args:
        spec: the specification to judge by; `None` judges nothing.
        coverages: the coverage models whose hits are collected.
    """

    def __init__(self, spec: Spec | None, coverages: Sequence[SpecCoverage] = ()) -> None:
        self._monitor = None if spec is None else spec.monitor()
        self._coverages = coverages
        self._collectors = [coverage.monitor() for coverage in coverages]
        takers: list[tuple[CheckedSpec, Callable[[int, Values], object]]] = [
            (coverage.spec, taker.step_ns)
            for coverage, taker in zip(coverages, self._collectors, strict=True)
        ]
        if spec is not None and self._monitor is not None:
            takers.append((spec.checked, self._monitor.step_ns))
        self._takers = [
            (frozenset((*checked.signals, *checked.events)), take) for checked, take in takers
        ]

    def start(self) -> None:
        """Start a new test: reset the monitor and the coverage."""
        if self._monitor is not None:
            self._monitor.reset()
        for collector in self._collectors:
            collector.reset()

    def observe(self, t_ns: int, values: Values) -> None:
        """Take one whole sample."""
        for names, take in self._takers:
            known = {name: value for name, value in values.items() if name in names}
            if known:
                take(t_ns, known)

    def finish(self, end_ns: int) -> Report:
        """The verdicts on a test that was observed up to `end_ns`."""
        if self._monitor is None:
            return report_of((), ())
        return self._monitor.finish_ns(end_ns)

    def hits(self, end_ns: int) -> Hits:
        """The hits of the test that was observed up to `end_ns`."""
        hits: dict[str, Mapping[str, Hit]] = {}
        for collector in self._collectors:
            hits |= collector.finish_ns(end_ns)
        return hits

    def illegal(self, hits: Hits) -> list[IllegalHit]:
        """The hits of bins that are declared illegal."""
        return [hit for coverage in self._coverages for hit in illegal(hits, coverage.bin_model)]
