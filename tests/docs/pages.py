"""The code blocks of pages in Markdown, and how each is run.

Behind the language of a fence stand marks: `file=NAME` writes the block to the page's folder,
`excerpt-of=PATH` says in which file of the project each of its lines stands, `wrong` that it has
errors, `elided` that `…` stands for anything in its output, `not-run="why"` that it is not run.
`python -m tests.docs.pages` counts.
"""

import doctest
import os
import re
import shlex
import shutil
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from tests import WITHOUT

from handover.cli import main as handover
from rvmon.cli import main as rvmon
from rvmon.errors import ModelError, SpecError
from rvmon.language.compile import compile_text
from rvmon.models.language.load import loads_network

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    path.relative_to(ROOT).as_posix()
    for folder in ("docs", ".")
    for path in (ROOT / folder).glob("**/*.md" if folder == "docs" else "*.md")
)
"""The pages of the documentation, the README and the rules for contributors."""

OWN_TESTS = {"docs/reference/what-changed-in-the-law.md": "tests/rvmon/verdicts/test_law_page.py"}
"""Pages whose blocks stand in a form of their own, with the test that runs them."""

NO_CODE = frozenset(("", "text"))
_FENCE = re.compile(r"^```([^\n`{]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_MARK = re.compile(r'([\w-]+)(?:=("[^"]*"|\S+))?')
_TOOK = re.compile(r"(?<=states, )[\d.]+ s|(?<=tests in )[\d.]+ s")
_SAYS = re.compile(r"print\(.*\)  # (.*)")


@dataclass(frozen=True)
class Block:
    """A block of code of a page, with its line, language and marks."""

    page: str
    line: int
    language: str
    marks: dict[str, str]
    text: str

    @property
    def place(self) -> str:
        """Where it stands."""
        return f"{self.page}:{self.line}"


def blocks(page: str) -> Iterator[Block]:
    """The blocks of a page that are code, in their order."""
    text = (ROOT / page).read_text(encoding="utf-8")
    for found in _FENCE.finditer(text):
        language, _, rest = found[1].strip().partition(" ")
        marks = {name: value.strip('"') for name, value in _MARK.findall(rest)}
        if language not in NO_CODE:
            line = text.count("\n", 0, found.start()) + 1
            yield Block(page, line, language, marks, found[2])


def own_test(page: str) -> str | None:
    """The test that runs a page of a form of its own."""
    return next((test for start, test in OWN_TESTS.items() if page.startswith(start)), None)


class Runner:
    """Runs the blocks of a page one after the other, in a folder of its own.

    Args:
        folder: the current directory; the folders of the project are linked there.
        captured: what the commands wrote to both outputs since it was last asked.
        names: what its programs know before the first.
    """

    def __init__(
        self, folder: Path, captured: Callable[[], tuple[str, str]], names: dict[str, Any]
    ) -> None:
        self.folder = folder
        self._captured = captured
        self._names = names
        for name in ("benchmarks", "docs", "specs", "src"):
            (folder / name).symlink_to(ROOT / name)
        shutil.copytree(ROOT / "examples", folder / "examples")  # its programs name where they are
        for name in ("base.csv", "base.rv", "base.toml"):
            shutil.copy(ROOT / "examples" / name, folder)

    def run(self, block: Block) -> None:
        """Run a block; an assertion or an exception says that it does something else."""
        if "not-run" in block.marks:
            assert len(block.marks["not-run"]) > 10, f"{block.place}: say why it is not run"
            return
        if (excerpt := block.marks.get("excerpt-of")) is not None:
            lines = {line.strip() for line in (ROOT / excerpt).read_text("utf-8").splitlines()}
            shown = {line.strip() for line in block.text.splitlines()}
            assert shown - lines <= {"", "..."}, block.place
            return
        if (file := block.marks.get("file")) is not None:
            path = self.folder / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block.text, encoding="utf-8")
        if block.language in ("rv", "ta"):
            self._compile(block)
        elif block.language in ("console", "sh"):
            self._commands(block)
        elif file is None:
            assert block.language == "python", f"{block.place}: nothing reads this block"
            self._program(block)

    def _compile(self, block: Block) -> None:
        read = compile_text if block.language == "rv" else loads_network
        found = ""
        try:
            read(block.text)
        except (SpecError, ModelError) as error:
            found = str(error)
        assert bool(found) == ("wrong" in block.marks), f"{block.place}\n{found}"

    def _commands(self, block: Block) -> None:
        """Commands begin with `$`; what stands below, up to the next, is what they print."""
        lines = block.text.splitlines()
        if block.language == "sh":
            for line in lines:
                self._output(line)
            return
        starts = [number for number, line in enumerate(lines) if line.startswith("$ ")]
        assert starts[:1] == [0], f"{block.place}: begins with no command"
        for start, end in zip(starts, [*starts[1:], len(lines)], strict=True):
            shown = self._output(lines[start].removeprefix("$ "))
            expected = "\n".join(line.rstrip() for line in lines[start + 1 : end])
            expected = _TOOK.sub("", expected).rstrip()
            if "elided" in block.marks:
                pattern = re.escape(expected).replace("…", r"[\s\S]*")
                assert re.fullmatch(pattern, shown), f"{block.place}\n{shown}"
            else:
                assert shown == expected, f"{block.place}: {lines[start]}\n{shown}"

    def _output(self, command: str) -> str:
        """What a command prints, times left out; or nothing if that goes to a file."""
        command = re.sub(r"\s+# .*", "", command)
        to_file = re.fullmatch(r"(.*) > ([\w./-]+)", command)
        words = shlex.split(to_file[1] if to_file else command)
        program = Path(words[0]).name
        if program in ("rvmon", "handover"):
            (rvmon if program == "rvmon" else handover)(words[1:])
            out, err = self._captured()
        else:
            path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
            settings = {"PATH": path, "PYTEST_ADDOPTS": WITHOUT}
            done = subprocess.run(  # noqa: S603 - our own pages
                words, capture_output=True, text=True, check=False, env={**os.environ, **settings}
            )
            out, err = done.stdout, done.stderr
        if to_file:
            (self.folder / to_file[2]).write_text(out, encoding="utf-8")
            return err
        shown = "\n".join(line.rstrip() for line in (err + out).splitlines())
        return _TOOK.sub("", shown).rstrip()

    def _program(self, block: Block) -> None:
        """Each `print` with a comment prints what that says; sessions are as for doctest."""
        if block.text.startswith(">>> "):
            session = doctest.DocTestParser().get_doctest(
                block.text, self._names, block.place, block.page, block.line
            )
            found: list[str] = []
            doctest.DocTestRunner(optionflags=doctest.ELLIPSIS).run(session, out=found.append)
            assert not found, "".join(found)
            self._names.update(session.globs)
            return
        exec(compile(block.text, block.place, "exec"), self._names)  # noqa: S102 - our own pages
        expected = _SAYS.findall(block.text)
        printed = self._captured()[0].splitlines()
        if len(expected) < block.text.count("print("):
            printed = [line for line in printed if line in expected]
        assert not expected or printed == expected, f"{block.place}\n{printed}"


def main() -> None:
    """Count the blocks by what becomes of them."""
    kinds: Counter[str] = Counter()
    left: list[str] = []
    for page in PAGES:
        for block in blocks(page):
            why = block.marks.get("not-run")
            kinds[
                "not run" if why else "in an excerpt" if "excerpt-of" in block.marks else "run"
            ] += 1
            if why:
                left.append(f"  {block.place}: {why}")
    print("blocks of code: " + ", ".join(f"{count} {kind}" for kind, count in kinds.items()))
    print("\n".join(left))


if __name__ == "__main__":
    main()
