"""The seed paper's handover testbench: generators, driver, simulation, checker, coverage."""
