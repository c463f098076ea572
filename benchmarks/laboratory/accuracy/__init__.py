"""Speed against error: solvers against a stored reference, models against the nonlinear response."""
