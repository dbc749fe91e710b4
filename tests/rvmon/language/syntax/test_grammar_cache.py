"""The cache of parser tables: it gives the same parser, and its faults do no harm."""

import json
from hashlib import sha256

from rvmon.language.syntax.grammar_cache import parser_of

GRAMMAR = 'start: "a" NUMBER+\nNUMBER: /[0-9]+/\n%ignore " "\n'
OPTIONS = {"parser": "lalr", "propagate_positions": True}


def test_a_parser_from_the_cache_is_the_same(own_cache):
    made = parser_of(GRAMMAR, OPTIONS)
    [path] = own_cache.glob("grammar-*")
    written = path.stat().st_ino
    known = parser_of(GRAMMAR, OPTIONS)
    assert path.stat().st_ino == written
    assert made.parse("a 1 2") == known.parse("a 1 2")
    assert known.parse("a 1 2").meta.end_pos == 5
    assert [one.name for one in known.terminals] == [one.name for one in made.terminals]
    assert known.rules == made.rules


def test_another_grammar_has_other_tables(own_cache):
    parser_of(GRAMMAR, OPTIONS)
    other = parser_of(GRAMMAR.replace('"a"', '"b"'), OPTIONS)
    assert len(list(own_cache.glob("grammar-*"))) == 2
    assert other.parse("b 1").children


def test_a_damaged_cache_is_ignored(own_cache):
    parser_of(GRAMMAR, OPTIONS)
    [path] = own_cache.glob("grammar-*")
    good = path.read_bytes()
    forged = json.dumps({"data": 1, "memo": {}}).encode()
    for wrong in (b"", good[:-9], sha256(forged).hexdigest().encode() + b"\n" + forged):
        path.write_bytes(wrong)
        assert parser_of(GRAMMAR, OPTIONS).parse("a 7").children[0] == "7"
        assert path.read_bytes() != wrong
    assert list(own_cache.glob("grammar-*")) == [path]
