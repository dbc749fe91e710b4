"""List which bags of last night need a look: failed ones first, each with the cause.

python examples/bag_triage.py FOLDER    # with .bag and .mcap files, and ROS 2 bag folders
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import rvmon

HERE = Path(__file__).parent
ORDER = ["F", "?", "I", "NT", "P"]
"""The order of urgency: failures, unreadable recordings (`?`), inconclusive verdicts, the rest."""


def bags_in(folder: Path) -> Iterator[Path]:
    """The recordings in a folder and its subfolders."""
    for path in sorted(folder.iterdir()):
        if path.suffix in (".bag", ".mcap") or (path / "metadata.yaml").is_file():
            yield path
        elif path.is_dir():
            yield from bags_in(path)


def look(spec: rvmon.Spec, bag: Path) -> tuple[str, str]:
    """The worst verdict on a bag, with the first attempt that has it, or the names if all pass."""
    try:
        report = spec.evaluate(bag)
    except rvmon.TraceError as error:
        return "?", str(error).splitlines()[0]
    worst = min((verdict.value for verdict in report.verdicts.values()), key=ORDER.index)
    shown = [attempt for attempt in report.attempts if attempt.verdict.value == worst != "P"]
    return worst, str(shown[0]) if shown else ", ".join(report.verdicts)


def triage(folder: Path) -> list[tuple[str, str, str]]:
    """Verdict, bag and cause of each bag, the worst first."""
    spec = rvmon.load(HERE / "base.rv").reading(binding=HERE / "base.toml")
    found = [(*look(spec, bag), str(bag.relative_to(folder))) for bag in bags_in(folder)]
    found.sort(key=lambda one: (ORDER.index(one[0]), one[2]))
    return [(verdict, bag, cause) for verdict, cause, bag in found]


if __name__ == "__main__":
    table = triage(Path(sys.argv[1]))
    for verdict, bag, cause in table:
        print(f"{verdict:2}  {bag}: {cause}")
    sys.exit(any(verdict in "F?" for verdict, _, _ in table))
