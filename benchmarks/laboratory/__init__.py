"""Studies for the development of the package, not installed with it; ``make help`` names the command of each."""
