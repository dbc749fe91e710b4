"""Which engine judges what: refusals, the choice of `auto`, and that all give the same verdicts."""

import random
import re

import numpy as np
import pytest
from tests.tools.compare import differences
from tests.tools.filled import BlockRecording
from tests.tools.forms import HANDING_ON

import rvmon
from rvmon.errors import RvmonError, UnknownNameError
from rvmon.monitor.engines.registry import ENGINES, engine_named
from rvmon.readers.blocks import Block
from rvmon.readers.source import Source
from rvmon.testing.oracle import evaluate
from rvmon.trace.sample import Sample

DECLARED = "signal p, q : bool\nsignal x : real{stale}\nevent e\n"
FORMS = {
    "response": ("upon e then within 3 ns q", "python", "columns"),
    "invariant": ("always x < 3", "python", "columns"),
    "episode": ("whenever p then within 2 ns q", "python", "columns"),
    "two clocks": ("upon e then within 5 ns (p and for 3 ns q)", "python", "python"),
    "windows": ("upon e then within 5 ns for 3 ns q", "network", "network"),
    "the end": ("upon end then p", "python", "python"),
    "what changed": ("upon changed(x) then within 2 ns q", "python", "python"),
    "a late window": ("whenever p then F[20 ns, 50 ns] q", "network", "network"),
    "looks back": ("upon e then O[0, 2 ns] (p and within 1 ns q)", "network", "network"),
    "captured": ("upon e then within 3 ns x > v let v = x", "automaton", "automaton"),
}
OTHERS = {
    "stale": ("always x < 3", "python", "python"),
    "late samples": ("always x < 3", "python", "python"),
    "clocked": ("always x < 3", "python", "python"),
}


def spec_of(form):
    """The specification of a form."""
    text = DECLARED.format(stale=" stale after 90 ns" if form == "stale" else "")
    heads = {"late samples": "max delay 5 ns\n", "clocked": "time sampled every 2 ns\n"}
    head = heads.get(form, "")
    return rvmon.loads(f"spec s\n{head}{text}requirement R\n  {(FORMS | OTHERS)[form][0]}\n")


def samples_of(seed):
    """A short trace in which all is updated in each sample."""
    rng = random.Random(seed)
    t, made = 0, []
    for _ in range(14):
        values = {name: rng.random() < 0.5 for name in ("p", "q", "e")}
        made.append(Sample(t, {**values, "x": float(rng.randrange(5))}))
        t += rng.randint(1, 4)
    return made


def source_of(samples):
    """The same as columns."""
    times = np.array([sample.t for sample in samples])
    columns = {name: np.array([one.values[name] for one in samples]) for name in samples[0].values}
    return Source(BlockRecording([Block(times, columns)]))


@pytest.mark.parametrize("form", FORMS | OTHERS)
def test_auto_judges_by_the_engine_that_is_named(form):
    """In a stream and in a recording; what `spec.engines` says is what the report says."""
    spec = spec_of(form)
    choice = spec.engines()["R"]
    assert (choice.online, choice.recording) == (FORMS | OTHERS)[form][1:]
    samples = samples_of(form)
    monitor = spec.monitor()
    for sample in samples:
        monitor.step_ns(sample.t, sample.values)
    assert monitor.finish().engine == choice.online
    assert spec.judge(source_of(samples)).engine == choice.recording


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("form", FORMS | OTHERS)
def test_a_refusal_has_a_reason_a_fix_and_an_engine_that_takes_it(form, engine):
    """Asked for by name, an engine judges what it does not refuse, and else says all three."""
    spec = spec_of(form)
    (one,) = spec._compiled.requirements.values()
    refusal = engine_named(engine).refuses(one)
    source = source_of(samples_of(form))
    if refusal is None or engine in HANDING_ON:
        assert engine == "auto" or engine in spec.judge(source, engine=engine).engine or refusal
    else:
        told = re.escape(f"R {refusal.reason}; "), re.escape(f" cannot evaluate it: {refusal.fix}")
        with pytest.raises(RvmonError, match=".*".join(told)):
            spec.judge(source, engine=engine)
    if refusal is not None:
        assert refusal.reason
        assert refusal.fix
        assert engine_named(refusal.engine).refuses(one) is None


@pytest.mark.law
@pytest.mark.parametrize("form", FORMS)
def test_all_engines_say_what_the_law_says(form):
    """Verdicts and instants of each engine that does not refuse, in streams and recordings."""
    spec = spec_of(form)
    (one,) = spec._compiled.requirements.values()
    for seed in range(3):
        samples = samples_of(seed)
        expected = evaluate(spec.checked, samples)
        for engine in ENGINES:
            if engine_named(engine).refuses(one) is not None:
                continue
            assert not differences(expected, spec.judge(source_of(samples), engine=engine))
            if engine != "columns":
                monitor = spec.monitor(engine=engine)
                for sample in samples:
                    monitor.step_ns(sample.t, sample.values)
                assert not differences(expected, monitor.finish())


def test_what_is_judged_beside_columns_is_told():
    """The report names the engines that judged, the fastest first, and does not write them down."""
    text = "".join(
        f"requirement R{n}\n  {FORMS[form][0]}\n"
        for n, form in enumerate(("response", "two clocks", "a late window"))
    )
    spec = rvmon.loads(f"spec s\n{DECLARED.format(stale='')}{text}")
    samples = samples_of(1)
    report = spec.judge(source_of(samples))
    assert report.engine == "columns, python, network"
    rows = spec.evaluate([(sample.t / 1e9, sample.values) for sample in samples])
    assert rows.engine == "python, network"
    assert rows == report
    assert rows.to_json() == report.to_json()
    assert rvmon.Report.from_json(report.to_json()).engine == ""


def test_columns_are_for_recordings_that_have_them(tmp_path):
    """By its name the engine `columns` says why something is none for it."""
    spec = spec_of("invariant")
    with pytest.raises(
        RvmonError, match="evaluates recordings, not streams: use the engine `auto`"
    ):
        spec.monitor(engine="columns")
    with pytest.raises(
        RvmonError, match="not evaluated by columns: its samples come one by one: use"
    ):
        spec.evaluate([(0, {"x": 1.0})], engine="columns")
    path = tmp_path / "a.csv"
    path.write_text("t,x\n0,1\n1,2\n1,3\n")
    with pytest.raises(RvmonError, match="its instants do not increase"):
        spec.evaluate(path, engine="columns")
    path.write_text("t,x\n0,1\n1,2\n")
    assert spec.evaluate(path, engine="columns").verdicts == {"R": "P"}


@pytest.mark.parametrize("ask", ["monitor", "evaluate"])
def test_an_unknown_engine_is_refused_with_those_that_there_are(ask):
    """The same words wherever it is asked for."""
    spec = spec_of("invariant")
    with pytest.raises(UnknownNameError, match=r"no engine `nope`: there are auto, .*network, c$"):
        spec.monitor(engine="nope") if ask == "monitor" else spec.evaluate([], engine="nope")
