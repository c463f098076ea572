"""Studies on sets of records: site calibration, fragility, risk, code checks and the self-test."""
