"""Where numba keeps the compiled kernels: a folder for each state of their sources.

Numba's own cache sees a change in the file of a kernel only, not in the kernels that it calls.
``python tests/kernel_cache.py`` prints the folder, for ``make``.
"""

import hashlib
from pathlib import Path

TOP = Path(__file__).parents[1]


def kernel_cache(kernels: Path = TOP / "models" / "rocking", top: Path = TOP) -> Path:
    """The folder for the state of all Python files below ``kernels``."""
    state = hashlib.sha256()
    for path in sorted(kernels.rglob("*.py")):
        state.update(path.relative_to(kernels).as_posix().encode() + b"\0" + path.read_bytes())
    return top / ".numba_cache" / state.hexdigest()[:16]


if __name__ == "__main__":
    print(kernel_cache())
