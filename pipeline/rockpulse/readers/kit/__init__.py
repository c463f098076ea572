"""The helpers that a format is written with; CONTRIBUTING.md lists the ten that most formats use."""
