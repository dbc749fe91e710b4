"""Generated C where no automaton judges: delay networks, their capacities, what they foresee."""

import random
import subprocess

import pytest
from tests.tools.gcc import SANITIZED, STRICT

import rvmon
from rvmon.codegen.c_source import c_files

pytestmark = pytest.mark.compiler

S = 10**9

FORMS = {
    "later": "whenever p then F[2 s, 5 s] q",
    "between ticks": "whenever p then F[2 s, 5 s] F[1 ns, 2 ns] q",
    "nested": "always (x > 3 -> F[0 s, 4 s] G[0 s, 2 s] y < 3)",
    "behind": "upon e then F[0 s, 3 s] once[0 s, 2 s] (q and within 1 s p)",
    "until": "whenever p then ((F[0 s, 1 s] q) U[1 s, 4 s] G[0 s, 1 s] x < 3)",
    "doubt": "upon known(x) and x > 3 then F[1 s, 3 s] (q and F[1 s, 2 s] p)",
    "end": "upon end then once[0 s, 3 s] (p and F[1 s, 2 s] q)",
    "for ever": "upon e then F[1 s, 2 s] always (p -> F[1 s, 3 s] q)",
}

MODELS = ("held", "sampled", "sampled every 500 ms")


def text_of(form: str, model: str = "held") -> str:
    """A specification with one requirement."""
    return (
        f"spec s\ntime {model}\nsignal p, q : bool\nsignal x, y : real\nevent e\n"
        f"requirement R1\n  {form}\n"
    )


def rows_of(seed: int, count: int, *, lost: bool = True):
    """Samples at irregular instants; some values are lost for a while."""
    rng = random.Random(seed)
    t = 0
    for _ in range(count):
        t += rng.choice([1, 250_000_000, 500_000_000, 500_000_000, 700_000_001, 3 * S])
        values: dict[str, object] = {}
        for name in ("p", "q"):
            if rng.random() < 0.5:
                values[name] = None if lost and rng.random() < 0.1 else rng.random() < 0.4
        for name in ("x", "y"):
            if rng.random() < 0.6:
                values[name] = None if lost and rng.random() < 0.1 else rng.uniform(0, 5)
        if rng.random() < 0.3:
            values["e"] = True
        yield t, values


def told(monitor, rows):
    """What each call returns, and the report."""
    calls = [[bare(one) for one in monitor.step_ns(t, values)] for t, values in rows]
    report = monitor.finish()
    return calls, report.verdicts, [bare(one) for one in report.attempts]


def bare(attempt):
    """An attempt without its reason."""
    return (
        attempt.number,
        attempt.in_doubt,
        attempt.triggered,
        attempt.decided,
        attempt.verdict,
        attempt.decision,
    )


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("form", FORMS)
def test_each_call_returns_what_the_network_of_python_does(form, model):
    """The same attempts at the same instants, while values are lost and found again."""
    spec = rvmon.loads(text_of(FORMS[form], model))
    if form != "doubt":
        assert "network" in {choice.online for choice in spec.engines().values()}
    for seed, lost in ((1, True), (2, False)):
        rows = list(rows_of(seed, 300, lost=lost))
        assert told(spec.monitor(engine="c"), rows) == told(spec.monitor(engine="network"), rows)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("engine", ["c", "network"])
def test_no_window_of_the_past_holds_what_is_taken_of_a_since_before_the_trace(engine, model):
    """`once` was met nowhere before the first position, which is in no window either."""
    form = "upon start then historically[0 s, 5 s] once F[0 s, 3 s] q"
    rows = [(0, {"q": False}), (1 * S, {}), (2 * S, {"q": True})]
    monitor = rvmon.loads(text_of(form, model)).monitor(engine=engine)
    decided = [one for t, values in rows for one in monitor.step_ns(t, values)]
    assert [(str(one.verdict), one.decided) for one in decided] == [("P", 2 * S)]


def test_what_stays_unknown_while_nobody_looks_fails_nothing():
    """A value lost since the network was last asked, which is not until the next change."""
    spec = rvmon.loads(text_of(FORMS["between ticks"]))

    def verdicts_of(engine):
        monitor = spec.monitor(engine=engine)
        for t in range(0, 800 * S, 20 * S):
            monitor.step_ns(t, {"p": True, "q": False})
            monitor.step_ns(t + 1000, {"p": False, "q": None})
            assert monitor.next_due is None or monitor.next_due > t + 1000
            monitor.step_ns(t + 3 * S, {"q": False})
            for n in range(t // S // 20 % 4):
                monitor.step_ns(t + (10 + n) * S, {"q": n % 2 == 0})
        return [str(one.verdict) for one in monitor.finish().attempts]

    assert verdicts_of("c") == verdicts_of("network") == ["I"] * 40


def test_columns_are_judged_alike():
    """Whole columns by the same C."""
    spec = rvmon.loads(text_of(FORMS["nested"]))
    rng = random.Random(3)
    columns = {
        "t": [0.25 * row for row in range(400)],
        "x": [rng.uniform(0, 5) for _ in range(400)],
        "y": [rng.uniform(0, 4) for _ in range(400)],
    }
    fast = spec.evaluate(columns, engine="c")
    assert len(fast.attempts) > 20
    found = [[bare(one) for one in report.attempts] for report in (fast, spec.evaluate(columns))]
    assert found[0] == found[1]


def test_what_time_alone_decides_is_foreseen():
    """`next_due` is the instant, however far away; then time alone decides."""
    spec = rvmon.loads(text_of("whenever p then F[3600 s, 7200 s] G[1 s, 2 s] q"))
    monitor = spec.monitor(engine="c")
    assert monitor.step_ns(0, {"p": True, "q": False}) == ()
    assert monitor.step_ns(1, {"p": False}) == ()
    due = monitor.next_due
    assert due == 7201 * S
    assert not monitor.advance_ns(due - 1)
    [failed] = monitor.advance_ns(100_000 * S)
    assert (failed.decided, failed.verdict) == (due, "F")


MAIN = """
#include "s.c"
#include <stdio.h>
static s_monitor m;
static s_attempt attempts[ATTEMPTS];
static long told[4];
static void hear_of(void *user, const s_record *r) { (void)user; told[r->verdict]++; }
int main(void) {
    uint32_t dice = 1;
    int run, i, j, full = 0;
    for (run = 0; run < 3; run++) {
        int64_t t = -1000000000;
        s_init(&m, attempts, ATTEMPTS, hear_of, NULL);
        for (i = 0; i < 1500; i++) {
            s_sample sample;
            memset(&sample, 0, sizeof sample);
            for (j = 0; j < 4; j++) {
                dice = dice * 1664525u + 1013904223u;
                sample.signal[j] = (dice >> 28) ? s_YES : s_UNKNOWN;
                sample.value[j] = (j < 2) ? (dice >> 20) & 1u : ((dice >> 16) & 63u) / 10.0;
            }
            sample.event[0] = (dice >> 10) % 3u ? s_NOTHING : s_YES;
            t += 1 + (int64_t)(dice >> 12) * ((dice >> 8) % 3u) * 500;
            if (!s_step(&m, t, &sample)) { return 1; }
            if (i % 5 == 0 && s_next_due(&m) <= t) { return 2; }
            if (i % 70 == 0) { t += 1000; s_advance(&m, t); }
        }
        if (!s_finish(&m, INT64_MIN)) { return 3; }
        full = full || s_overflowed(&m);
    }
    printf("%ld %ld %ld %d\\n", told[0], told[1], told[2], full);
    return 0;
}
"""


def driven(text, folder, ranges, attempts=4000):
    """What C tells of random samples: failed, passed, undecided, and whether room ran out."""
    for name, source in c_files(rvmon.loads(text).plan()).texts.items():
        (folder / name).write_text(source)
    (folder / "main.c").write_text(MAIN)
    flags = [*STRICT, *SANITIZED, f"-DS_RANGES={ranges}", f"-DATTEMPTS={attempts}"]
    for words in (["gcc", *flags, "main.c", "-o", "main"], ["./main"]):
        done = subprocess.run(  # noqa: S603
            words, cwd=folder, capture_output=True, text=True, check=False, timeout=60
        )
        assert done.returncode == 0, done.stderr
    return [int(word) for word in done.stdout.split()]


@pytest.mark.parametrize(
    ("model", "ranges", "attempts"),
    [
        (MODELS[0], 1, 4000),
        (MODELS[0], 4096, 4000),
        (MODELS[0], 4096, 9),
        (MODELS[1], 3, 4000),
        (MODELS[2], 1, 4000),
        (MODELS[2], 4096, 4000),
    ],
)
def test_networks_run_clean(model, ranges, attempts, tmp_path):
    """No finding of the sanitizers; a capacity that is too small is told and harms nothing."""
    forms = [form for name, form in FORMS.items() if name != "doubt"]
    head = text_of("", model).partition("requirement")[0]
    text = head + "".join(f"requirement R{n}\n  {form}\n" for n, form in enumerate(forms))
    assert driven(text, tmp_path, ranges, attempts)[-1] == (ranges < 100 or attempts < 100)


def test_where_room_ran_out_nothing_passes_at_the_end(tmp_path):
    """What is to hold for ever is not held to the end if not all of it was kept."""
    failed, passed, undecided, full = driven(text_of(FORMS["for ever"]), tmp_path, ranges=1)
    assert (failed, passed, full) == (0, 0, 1)
    assert undecided > 1000
