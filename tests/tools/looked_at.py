"""Pages as a browser shows them: what a person could not read, reach or name."""

import html
import json
import subprocess
from collections.abc import Mapping
from pathlib import Path

WIDTHS = (400, 1400)
SCHEMES = ("light", "dark")

_SCRIPT = Path(__file__).with_suffix(".js").read_text(encoding="utf-8")


def faults(chromium: str, folder: Path, pages: Mapping[str, str]) -> list[str]:
    """What is wrong with pages, each in two widths, light and dark, in one start of the browser."""
    frames = [
        f'<iframe data-name="{html.escape(name)}" data-width="{width}" srcdoc="{html.escape(text)}"'
        f' style="color-scheme:{scheme};width:{width}px;height:900px;border:0"></iframe>'
        for name, text in pages.items()
        for width in WIDTHS
        for scheme in SCHEMES
    ]
    place = folder / "looked-at.html"
    content = f"<!DOCTYPE html><meta charset=utf-8><body>{''.join(frames)}"
    place.write_text(f"{content}<script>{_SCRIPT}</script>", encoding="utf-8")
    found = dumped(chromium, f"file://{place}")[0].partition("<body>")[2].partition("</body>")[0]
    read: list[str] = json.loads(html.unescape(found))
    return read


def dumped(chromium: str, address: str) -> tuple[str, str]:
    """A page after its script ran, and what the browser says of it."""
    words = ["--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=2000"]
    done = subprocess.run(  # noqa: S603 - the browser of the fixture
        [chromium, *words, "--enable-logging=stderr", "--dump-dom", address],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return done.stdout, done.stderr
