"""Networks of timed automata: text forms, zone model checker, witnesses, conformance, suites."""
