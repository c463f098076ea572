"""Studies of our own questions, no part of the installed package; ``make help`` names the command of each."""
