"""``rockpulse completion``: print a shell script that completes commands, options, kinds of pictures and file names."""

import argparse
from collections.abc import Iterator

from rockpulse.commands.parser import Verb
from rockpulse.commands.terminal import tell

#: Command that installs the script, for each shell.
HOW = {
    "bash": "rockpulse completion bash > ~/.local/share/bash-completion/completions/rockpulse",
    "zsh": "rockpulse completion zsh > ~/.zfunc/_rockpulse     (~/.zfunc in fpath, before compinit)",
    "fish": "rockpulse completion fish > ~/.config/fish/completions/rockpulse.fish",
    "powershell": "rockpulse completion powershell >> $PROFILE",
}

#: Placeholders in the help (metavariables) for names of files.
FILES = frozenset(
    "PATHS RESULTS FILE SITE REPORT TABLE BEFORE AFTER FRAGILITY CURVE CONFIG OUT".split()  # noqa: SIM905
)


def _run(args: argparse.Namespace) -> int:
    import shtab

    from rockpulse.model_table import MODELS
    from rockpulse.readers import UNITS
    from rockpulse.views.plots.picture_kinds import KINDS

    words = {"KIND": tuple(KINDS), "UNIT": tuple(UNITS), "MODEL": tuple(MODELS)}
    for action in _actions(args.program):
        metavar = str(action.metavar)
        if action.choices is None and metavar in words:
            action.choices = words[metavar]
        if metavar in FILES:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
        if metavar == "FOLDER":
            action.complete = shtab.DIRECTORY  # type: ignore[attr-defined]
    tell(shtab.complete(args.program, shell=args.shell))
    return 0


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    for action in parser._actions:
        yield action
        if isinstance(action, argparse._SubParsersAction):
            for verb in action.choices.values():
                yield from _actions(verb)


VERB = Verb(
    name="completion",
    summary="print a script for shell completion",
    description="Print a script with which a shell completes commands, options, kinds of pictures, units and file "
    "names. The examples show where to put it; it takes effect in the next shell.",
    options=({"shell": ("shell that reads the script", {"choices": tuple(HOW), "metavar": None})},),
    run=_run,
    examples=tuple(HOW.values()),
)
