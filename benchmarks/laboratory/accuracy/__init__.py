"""Speed and error of the solvers compared with a stored reference, and of models with the nonlinear response."""
