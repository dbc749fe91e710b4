"""Wrong arguments of each command are refused with cause and fix."""

import os
import shlex

import pytest
from tests.rvmon.cli.conftest import LABELLED
from tests.tools.each import each

from rvmon.cli import main

pytestmark = pytest.mark.slow

LAMP = """automaton Lamp {
  location off
  location on
  start off
  edge off -> on as pressed
  edge on -> off as dark
}
query lit: E<> Lamp.on
query dead: E<> deadlock
"""
FILES = {
    "labelled.rv": LABELLED,
    "late.rv": "max delay 1 s\nevent e\nrequirement R\n  upon e then within 1 s e\n",
    "bare.rv": "spec bare\nsignal closed : bool\ncoverpoint c = closed {no: false}\n",
    "no_requirement.rv": "spec s\nsignal closed : bool\n",
    "old.rv": "spec old\n# geöffnet\n",
    "wrong.rv": "requirement R always nothing\n",
    "P.csv": "t,closed,knock\n0,1,\n1,,1\n2,0,\n5,,\n30,,\n",
    "NT.csv": "t,closed,knock\n0,1,\n5,,\n",
    "cut.csv": "t,closed,knock\n0,1,\n1,maybe,\n",
    "text.csv": "t,text\n0,hello\n1,there\n",
    "text.jsonl": '{"t": 0, "text": "hello"}\n',
    "empty.jsonl": "\n",
    "lamp.ta": LAMP,
    "b.toml": '[bind.goo]\ntopic = "/go"\n',
    "a.mcap": "\x89MCAP0\r\n",
    "bag/metadata.yaml": "",
    **dict.fromkeys(("file", "door.c", "known.toml", "a.ulg", "a.blf", "a.mf4", "a.h5"), ""),
}
ESCAPE = "a\x1b[31m\x9b8m\u202e"
ESCAPED = r"a\x1b[31m\x9b8m\u202e"
SECONDS = "expected seconds, or a number with its unit"
NO_PIECE = "this format cannot be clipped; these can: CSV"


@pytest.fixture
def folder(door):
    """A folder with an input of each kind."""
    (door / "bag").mkdir()
    os.mkfifo(door / "pipe")
    for name, text in FILES.items():
        (door / name).write_bytes(text.encode("latin1"))
    for name, target in {"link.csv": "P.csv", "link.rv": "door.rv"}.items():
        (door / name).symlink_to(target)
    assert main(["run", "door.rv", "P.csv", "--quiet", "--coverage", "a.cov"]) == 0
    assert main(["clip", "door.rv", "P.csv", "D1", "-o", "a.rvcase"]) == 0
    return door


def contents(folder):
    return {path: path.read_bytes() for path in folder.rglob("*") if path.is_file()}


MISTAKES = {
    "rvmon": [
        ("chek door.rv", "did you mean `check`?"),
        ("", "evaluate recordings against a specification"),
    ],
    "check": [
        ("door.rv --const T", "expected NAME=VALUE"),
        ("gone.rv", "gone.rv: No such file or directory"),
        ("old.rv", "old.rv: not UTF-8 text (invalid start byte at byte 13)"),
        ("door.rv --binding gone.toml", "gone.toml: No such file or directory"),
        ("door.rv --binding b.toml", "`goo`"),
        *((f"door.rv --analyse --seconds={word}", "--seconds") for word in ("nan", "-1", "x")),
        (ESCAPE, ESCAPED),
    ],
    "clip": [
        ("door.rv P.csv -o b.csv", "an attempt such as R1#3, or --from T and --to T"),
        ("door.rv P.csv D1", "name the output"),
        ("door.rv P.csv D1 -o P.csv", "P.csv: it is an input: name another"),
        ("door.rv P.csv D1 -o link.csv", "link.csv: it is an input: name another"),
        ("door.rv P.csv D1 -o b.bag", "a piece of P.csv ends in .csv"),
        ("door.rv P.csv D1 -o no/b.csv", "there is no folder no"),
        ("door.rv P.csv D1#7 -o b.csv", "no attempt D1#7: there is D1#1 only"),
        ("door.rv P.csv D9 -o b.csv", "no requirement `D9`"),
        ("door.rv P.csv D1 --before=-1s -o b.csv", "expected a duration of at least 0"),
        ("door.rv P.csv D1 --before '1 day' -o b.csv", SECONDS),
        ("door.rv P.csv --from 18 --to 19 -o b.csv", "there is nothing between 18 s and 19 s"),
        ("door.rv P.csv --from 31 -o b.csv", "there is nothing from 31 s on"),
        ("door.rv P.csv --from 18 --clock header -o b.csv", "use --map"),
        ("door.rv P.csv --from 0 -o b.rvcase", "name it, such as R1#3"),
        ("door.rv P.csv D1 --reproducer b", ".rvcase"),
        ("door.rv gone.csv D1 -o b.csv", "gone.csv: No such file or directory"),
        *((f"door.rv a.{end} D1 -o b.csv", NO_PIECE) for end in ("ulg", "blf", "mf4", "h5")),
        ("door.rv a.ulg D1 --reproducer a.rvcase", NO_PIECE),
    ],
    "compare": [("gone.csv P.csv", "there is no file gone.csv")],
    "conform": [
        ("gone.ta P.csv", "gone.ta: No such file or directory"),
        ("lamp.ta gone.csv", "gone.csv: No such file or directory"),
        ("lamp.ta P.csv --observe light", "no label `light`"),
        ("lamp.ta P.csv --observe dark --tolerance -1", "at least 0"),
        ("lamp.ta P.csv --observe dark --tolerance nan", SECONDS),
        ("lamp.ta P.csv --observe dark --until -1", "at least 0"),
        ("lamp.ta text.csv", "an action of the model: its actions are pressed, dark"),
        ("lamp.ta text.jsonl", "nothing in it is an action of the model"),
        ("lamp.ta text.csv --observe dark", "no column `dark`"),
    ],
    "cover": [
        ("gone.cov", "there is no file gone.cov: `rvmon run --coverage gone.cov` makes it"),
        (".", "is a folder"),
        ("a.cov --require much", "expected a percentage, such as 95%, not much"),
        ("a.cov --require 101", "expected a percentage"),
        ("a.cov --bins=D2", "no group named `D2`: there are D1"),
        ("a.cov --compare none", "there is no file none"),
        ("a.cov --merge /none/a.cov", "there is no folder"),
        ("a.cov --report none/a.html", "cannot write none/a.html: No such file"),
        ("a.cov --report a.cov", "a.cov: it is an input: name another"),
        ("a.cov --ucis a.cov", "a.cov: it is an input: name another"),
        ("a.cov --report v.csv --ucis v.csv", "v.csv: two results would go there"),
    ],
    "evidence": [("gone.zip", "gone.zip: No such file or directory")],
    "explain": [
        ("door.rv D9", "no requirement `D9`: there are D1"),
        ("door.rv D1 D1", "two different ones"),
        ("labelled.rv D0 D1 D2", "two different ones"),
        ("RV999", "no diagnostic `RV999`"),
        ("door.rv D1 --runs 0", "--runs"),
        ("no_requirement.rv", "no requirement to explain"),
        ("old.rv", "old.rv: not UTF-8 text (invalid start byte at byte 13)"),
        (ESCAPE, ESCAPED),
    ],
    "export": [
        ("door.rv --to json -o door.rv", "door.rv: it is an input: name another"),
        ("lamp.ta --to dot -o lamp.ta", "lamp.ta: it is an input: name another"),
        ("door.rv --to dot --only D7", "there are D1"),
        ("door.rv --to hoa --only D1", "error: D1 has windows of time"),
        ("door.rv --to c", "C is several files: name a folder with -o DIR"),
        ("door.rv --to c -o door.c", "C is several files: name a folder with -o DIR"),
        ("wrong.rv --to c -o made", "RV012"),
        ("late.rv --to c -o made", "leave out `max delay` and give it samples in order"),
        *((f"no_requirement.rv --to {form}", "no requirement") for form in ("dot", "hoa", "json")),
        ("door.rv --to uppaal", "is not a model"),
        ("lamp.ta --to c", "--to c is for specifications"),
        ("lamp.ta --to dot --const X=a", "expected NAME=NUMBER"),
        ("lamp.ta --to dot --const X=1", "no constant `X`"),
        ("lamp.ta --to dot -o /nowhere/a.dot", "No such file"),
    ],
    "format": [
        ("old.rv", "`iconv -f latin1 -t utf-8`"),
        (ESCAPE, ESCAPED),
    ],
    "init": [
        ("gone.mcap", "gone.mcap: No such file or directory"),
        ("gone.bag --for door.rv", "gone.bag: No such file or directory"),
        ("P.csv --for door.rv", "use --map"),
        ("P.csv -o P.csv --force", "P.csv: it is an input: name another"),
        ("P.csv -o door.rv", "--force"),
        ("", "name a recording, or --campaign with a folder"),
        ("P.csv --campaign there", "name a recording, or --campaign with a folder"),
    ],
    "look": [
        ("gone.csv", "gone.csv: No such file or directory"),
        ("P.csv -o P.csv", "P.csv: it is an input: name another"),
        ("P.csv door.rv -o link.rv", "link.rv: it is an input: name another"),
    ],
    "run": [
        ("bag P.csv", "bag: a folder; a specification (.rv) is expected here"),
        ("door.rv", "rvmon run examples/base.rv examples/base.csv\n"),
        ("door.rv P.csv --repot out", "did you mean `--report`?"),
        ("door.rv P.csv --bogus", "unrecognized arguments: --bogus\n"),
        (f"door.rv P.csv --{ESCAPE}", ESCAPED),
        ("door.rv P.csv --format jsn", "did you mean `json`?"),
        (f"door.rv P.csv --format {ESCAPE}", ESCAPED),
        (f"{ESCAPE} P.csv", ESCAPED),
        ("dor.rv P.csv", "dor.rv: No such file or directory: did you mean `door.rv`?"),
        ("door.rv PP.csv", "did you mean `P.csv`?"),
        ("door.rv ./NTT.csv", "did you mean `NT.csv`?"),
        *((f"door.rv {name}", "No such file or directory\n") for name in ("g/", "g", "g.odd")),
        ("door.rv gone/ --join", "gone/: No such file or directory\n"),
        ("door.rv gone.csv gone2.csv --join", "gone.csv: No such file or directory"),
        ("door.rv P.csv --only D9", "no requirement `D9`"),
        ("door.rv P.csv --only ''", "there are D1"),
        ("labelled.rv P.csv --tag saftey", "the tag `saftey`: did you mean `safety`?\n"),
        ("labelled.rv P.csv --severity=", "has the severity ``: there are high, low\n"),
        (
            "labelled.rv P.csv --tag knocks --severity low",
            "no requested requirement has the severity low, the tag knocks\n",
        ),
        ("no_requirement.rv P.csv", "s has no requirement: there is nothing to check"),
        ("bare.rv P.csv --report rep", "a page shows requirements, and bare has none: add one"),
        ("door.rv P.csv --jobs 0", "at least 1, not 0"),
        ("door.rv P.csv --until nan", SECONDS),
        ("door.rv P.csv --until 1e30", "12.5, 500ms, not 1e30"),
        ("door.rv P.csv --until '3 days'", "not 3 days"),
        ("door.rv P.csv --until=-1", "no sample up to --until -1 s"),
        ("door.rv P.csv --report rep --junit gone/j.xml", "error: cannot write gone/j.xml"),
        ("door.rv P.csv --junit .", "error: cannot write ."),
        ("door.rv P.csv --report file", "cannot write to file: it is a file: name a folder"),
        ("door.rv P.csv --coverage none/c.db", "there is no folder none"),
        ("door.rv P.csv --out v.xls", "v.xls"),
        ("door.rv P.csv --out none/v.csv", "there is no folder none"),
        ("door.rv P.csv --out v.csv --junit ./v.csv", "v.csv: two results would go there"),
        ("door.rv P.csv --out link.csv", "link.csv: it is an input: name another"),
        ("door.rv P.csv --junit link.csv", "link.csv: it is an input: name another"),
        ("door.rv P.csv NT.csv --join --out NT.csv", "NT.csv: it is an input: name another"),
        (
            "door.rv P.csv --known known.toml --junit known.toml",
            "known.toml: it is an input: name another",
        ),
        ("door.rv P.csv --resume", "name the file with --out"),
        ("door.rv P.csv NT.csv --shard 1/2", "name that with --out"),
        ("door.rv P.csv NT.csv --out v.csv --shard 3/9", "there are 2 recordings"),
        *((f"door.rv P.csv --shard {it}", "--shard") for it in ("0/2", "3/2", "1", "a/b", "/2")),
        ("door.rv - --evidence e.zip", "name existing files"),
        ("door.rv gone.csv --evidence e.zip", "name existing files"),
        ("door.rv P.csv P.csv --evidence e.zip", "each once"),
        ("gone.rvcase", "gone.rvcase: No such file"),
        ("a.rvcase P.csv", "contains its recording"),
        ("a.rvcase --map closed=q", "leave out these options"),
    ],
    "verify": [
        ("gone.ta", "No such file"),
        ("lamp.ta --query 'E<> Nobody.safe'", "no automaton `Nobody`"),
        ("lamp.ta --query 'E<> Nobody.safe'", "help: there are Lamp"),
        ("lamp.ta --query cross", "no query `cross`\nhelp: it has "),
        ("lamp.ta --query Lamp.on", "a query refers to runs"),
        ("lamp.ta --query lit,dead", "write --query lit --query dead"),
        ("lamp.ta --const N", "expected NAME=NUMBER"),
        ("lamp.ta --const N=" + "9" * 5000, "expected NAME=NUMBER"),
        ("lamp.ta --const M=2", "no constant `M`"),
        ("lamp.ta --max-states 0", "at least 1"),
        ("lamp.ta --max-memory 0", "at least 1"),
        ("lamp.ta --max-seconds nan", SECONDS),
        ("lamp.ta --max-seconds -1", "at least 0"),
        ("lamp.ta --spec door.rv --suite edges", "not allowed with"),
        ("lamp.ta --suite edges --query lit", "does nothing"),
        ("lamp.ta --bind a=b", "does nothing without --spec"),
        (ESCAPE, ESCAPED),
    ],
    "watch": [
        ("gone.rv text.jsonl", "gone.rv"),
        ("no_requirement.rv text.jsonl", "s has no requirement: there is nothing to check"),
        ("door.rv gone.jsonl", "gone.jsonl: No such file or directory"),
        ("door.rv empty.jsonl", "it has no lines"),
        ("door.rv .", "directory"),
        ("door.rv P.csv", "by `rvmon run door.rv P.csv`"),
        ("door.rv a.mcap --state kept", "by `rvmon run door.rv a.mcap`"),
        ("door.rv bag", "by `rvmon run door.rv bag`"),
        ("door.rv text.jsonl --state pipe", "is not a regular file"),
        ("door.rv text.jsonl --state door.rv", "door.rv: it is an input: name another"),
        ("door.rv text.jsonl --only D2", "D2"),
        ("door.rv text.jsonl --map clsed=x", "did you mean `closed`?"),
        ("door.rv text.jsonl --publish v", "--format json"),
        ("door.rv mqtt://localhost/x --robot id", "first +"),
        ("door.rv mqtt://localhost/x --sim-time", "/clock"),
        ("door.rv dds:1 --robot id", "start one watch for each"),
        ("door.rv dds:1 --time t:ms", "--binding"),
    ],
    "why": [
        ("door.rv P.csv", "required: ID#N"),
        ("door.rv P.csv D1#9", "there is D1#1 only"),
        ("door.rv P.csv D9", "no requirement `D9`"),
        ("door.rv P.csv D1#x", "names no attempt"),
        ("door.rv gone.ulg D1", "gone.ulg: No such file or directory"),
        ("gone.rv P.csv D1", "gone.rv: No such file or directory"),
        ("door.rv - D1", "save the recording"),
        ("door.rv cut.csv D1", "line 3"),
        ("door.rv NT.csv D1", "never triggered"),
        ("a.rvcase P.csv D1#1", "name only an attempt"),
    ],
}


@pytest.mark.parametrize("command", MISTAKES)
def test_wrong_arguments_are_reported_and_no_file_changes(command, folder, says):
    """The exit code is 2, a close name is proposed, and no escape reaches the terminal."""
    before = contents(folder)

    @each(("words", "told"), MISTAKES[command])
    def said(words, told):
        shown = says(2, *[command][command == "rvmon" :], *shlex.split(words))
        assert told in shown.err
        assert ("did you mean" in shown.err) is ("did you mean" in told)
        assert not [bad for bad in ("Traceback", "internal error", "\x1b") if bad in shown.err]
        assert shown.out == ""
        assert contents(folder) == before

    said()
