"""What NaN says, by the command line."""

from rvmon.cli import main


def test_the_command_line_reads_nan_as_it_is_told(tmp_path, capsys):
    """`--nan no-update` holds the value before; without it the finding names the option."""
    spec, trace = tmp_path / "a.rv", tmp_path / "a.csv"
    spec.write_text("spec s\nsignal x : real\nrequirement R1\n  always x < 3\n")
    trace.write_text("t,x\n" + "".join(f"{t},{('1', 'nan')[t % 2]}\n" for t in range(8)))
    assert main(["run", str(spec), str(trace), "--strict"]) == 1
    assert "rvmon run --nan no-update" in " ".join(capsys.readouterr().out.split())
    assert main(["run", str(spec), str(trace), "--strict", "--nan", "no-update"]) == 0
