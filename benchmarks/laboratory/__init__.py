"""Studies for the development of the package, which are not installed; ``make help`` names the command of each."""
