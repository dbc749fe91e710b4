"""The peers' own environment: made once, beside the benchmarks, from the package index."""

from __future__ import annotations

import json
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).parent
HOME = HERE.parent / ".env"
REQUIREMENTS = HERE / "requirements.txt"


@dataclass(frozen=True, slots=True)
class Environment:
    """What was installed.

    Attributes:
        python: the interpreter that has the peers.
        versions: of each package that installed, by name.
        missing: for each package that did not install, the reason in one line.
    """

    python: Path
    versions: dict[str, str]
    missing: dict[str, str]


def prepare() -> Environment:
    """Make the environment if it is not there or the pins have changed; return what it holds."""
    stamp = HOME / "peers.json"
    pins = [line for line in REQUIREMENTS.read_text().splitlines() if line and line[0] != "#"]
    python = HOME / "bin" / "python"
    if stamp.exists():
        found = json.loads(stamp.read_text())
        if found["pins"] == pins:
            return Environment(python, found["versions"], found["missing"])
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", str(HOME)], check=True)
    versions: dict[str, str] = {}
    missing: dict[str, str] = {}
    for pin in pins:
        name, _, version = pin.partition("==")
        reason = _install(python, pin)
        if reason is None:
            versions[name] = version
        else:
            missing[name] = reason
    stamp.write_text(json.dumps({"pins": pins, "versions": versions, "missing": missing}))
    return Environment(python, versions, missing)


def _install(python: Path, pin: str) -> str | None:
    command = [str(python), "-m", "pip", "install", "--quiet", "--disable-pip-version-check", pin]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode == 0:
        return None
    errors = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
    return (errors or done.stderr.splitlines() or ["pip failed"])[-1]
