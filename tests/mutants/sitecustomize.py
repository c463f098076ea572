"""Python imports this file at its start where its folder is on PYTHONPATH: it has one module read from another file.

The environment names both: MUTATED is the module in the sources and MUTANT the file with its changed text. The sources
stay as they are, no bytecode of the changed text is kept, and the commands that tests start see the change, too.
"""

import os
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import CodeType

original = SourceFileLoader.get_code


def get_code(loader: SourceFileLoader, name: str) -> CodeType | None:
    """The code of a module, compiled from the changed text where it is the one that was changed."""
    if loader.path != os.environ["MUTATED"]:
        return original(loader, name)
    return loader.source_to_code(Path(os.environ["MUTANT"]).read_bytes(), loader.path)


SourceFileLoader.get_code = get_code
