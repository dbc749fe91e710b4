"""The handover testbench of the seed paper: test generators, driver, simulation, requirements.

Source: Araiza-Illan et al. 2015; see `handover.campaign.table1`.
"""
