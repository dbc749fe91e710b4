"""What an update costs counts, sums and extremes, by how many updates lie in the window."""

from __future__ import annotations

import time

import rvmon

FORMS = {
    "count": "upon count(e, {d} s) >= 1000000000 then e",
    "duration": "upon duration(a, {d} s) >= {d} s then e",
    "share": "upon share(a, {d} s) >= 100 % then e",
    "max": "upon max(x, {d} s) <= 0 then e",
    "sum": "upon sum(x, {d} s) < 0 then e",
    "mean": "upon mean(x, {d} s) > 3.5 then e",
    "integral": "upon integral(x, {d} s) < 0 s then e",
    "mean, moving": "upon mean(x, {d} s) > x then e",
    "integral()": "upon integral(x) < 0 s then e",
}
WINDOWS = (10, 1_000, 100_000)
UPDATES = 200_000


def nanoseconds(form: str, window: int) -> float:
    """Of one update, one a second, once the window is full."""
    spec = rvmon.loads(
        "spec s\nsignal a : bool\nsignal x : real\nevent e\n"
        f"requirement R\n  {form.format(d=window)}\n"
    )
    samples = [{"a": n % 2 == 0, "x": float(n % 7), "e": n % 3 == 0} for n in range(42)]
    monitor = spec.monitor()
    for n in range(window):
        monitor.step(float(n), samples[n % 42])
    began = time.perf_counter()
    for n in range(window, window + UPDATES):
        monitor.step(float(n), samples[n % 42])
    return (time.perf_counter() - began) / UPDATES * 1e9


def main() -> None:
    """Print a row for each form."""
    print(f"{'ns per update':14}" + "".join(f"{window:>12,}" for window in WINDOWS))
    for name, form in FORMS.items():
        costs = (nanoseconds(form, window) for window in WINDOWS)
        print(f"{name:14}" + "".join(f"{cost:12.0f}" for cost in costs))


if __name__ == "__main__":
    main()
