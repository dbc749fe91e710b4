"""Mutation testing: which small wrong changes of code, and of requirements, does a suite see?

`python_mutants` has the changes of the code under test, by the table of `python_operators`;
`baseline` plays tests on the code as it is, `play` on each mutant, `survivors` says what a survivor
asks. `spec_mutants` does it to requirements, on recorded runs; `report` has the figures.

Source: DeMillo, Lipton, Sayward 1978, Hints on Test Data Selection; King and Offutt 1991, A Fortran
Language System for Mutation-Based Software Testing.
"""
