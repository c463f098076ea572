"""Studies on sets of records: site calibration, fragility, risk, record selection, code checks and the self-test."""
