"""Atomic writing: a temporary file is written, and then replaces the target; only results are ever replaced."""

import glob
import os
import re
import secrets
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from rockpulse.errors import ResultsError

#: Value of the root attribute `kind` for an assessment, and for files without this attribute.
ASSESSMENT = "assessment"
#: Largest size of the parts of a file that are not values, mostly names and attributes [bytes].
LAYOUT = 1024**2

#: For each suffix of a file that another command makes from results: kind of file, command, usual suffix.
OTHERS = {
    **dict.fromkeys((".csv", ".tsv", ".txt", ".xls", ".xlsx"), ("a table", "export", ".csv")),
    **dict.fromkeys((".htm", ".html"), ("a report", "report", ".html")),
    **{suffix: ("a picture", "plot", suffix) for suffix in (".svg", ".png", ".pdf")},
}

#: Suffixes of other files that a user may give by mistake.
TEXTS = (".toml", ".json", ".md", ".parquet")
DAMAGED = "damaged file"
SIGNATURE = b"\x89HDF\r\n\x1a\n"


def check_target(path: str | os.PathLike[str], overwrite: bool = False, kind: str = ASSESSMENT) -> Path:
    """Return the real path of a results file to be written; raise ResultsError if it cannot be written."""
    target = Path(os.path.realpath(path))
    try:
        if target.exists():
            _check_replaceable(target, path, overwrite, kind)
        _check_name(Path(path))
        if not target.parent.is_dir():
            raise ResultsError(f"{path}: there is no folder {target.parent}; create it first")
        part = _part(target)
        part.touch(exist_ok=False)  # fails for a name that is too long with the temporary suffix
        part.unlink()
    except OSError as error:
        raise ResultsError(f"{path}: cannot write in {target.parent}: {error.strerror}; use another name") from error
    return target


@contextmanager
def replacing(
    path: str | os.PathLike[str], overwrite: bool = False, kind: str = ASSESSMENT, size: int = 0
) -> Iterator[Path]:
    """Yield a temporary path in a ``with`` block; at its end, the file written there replaces the target."""
    target = check_target(path, overwrite, kind)
    free = shutil.disk_usage(target.parent).free
    if free < size + LAYOUT:
        raise ResultsError(
            f"{path}: the results need {(size + LAYOUT) / 1e6:.0f} MB, but {free / 1e6:.0f} MB are free in "
            f"{target.parent}; free some space there"
        )
    part = _part(target)
    try:
        yield part
        flush(part, os.O_RDWR)
        check_target(path, overwrite, kind)  # another process may have written it during the run
        if target.exists():
            shutil.copymode(target, part)
        part.replace(target)
    except OSError as error:
        hidden = re.search(r"errno = (\d+)", str(error))  # HDF5 gives the error number only in a long text
        reason = os.strerror(int(hidden[1])) if hidden else error.strerror or str(error)
        raise ResultsError(f"{path}: cannot write the results: {reason}") from error
    finally:
        part.unlink(missing_ok=True)
    if os.name == "posix":  # on other systems a folder cannot be opened
        flush(target.parent, os.O_RDONLY)


def remove_parts(path: str | os.PathLike[str]) -> None:
    """Remove temporary files of killed runs; call only if no other process can be writing the results file."""
    target = Path(os.path.realpath(path))
    for left in target.parent.glob(f".{glob.escape(target.name)}.{'[0-9a-f]' * 8}.part"):
        left.unlink()


def journal_path(target: str | os.PathLike[str]) -> Path:
    """Return the path of the journal of the run that writes the results file `target`."""
    return Path(os.path.realpath(target) + ".journal")


def kind_in_words(kind: str) -> str:
    """Return a kind of file in words, such as "a fragility file"."""
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind} file"


def _part(target: Path) -> Path:
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")


def _check_name(path: Path) -> None:
    """Raise ResultsError if the name has the suffix of another format, as results are always HDF5."""
    plain = path.with_suffix("") if path.suffix.lower() == ".gz" else path
    results, found = plain.with_suffix(".h5"), ""
    if plain.suffix.lower() in OTHERS:
        what, verb, suffix = OTHERS[plain.suffix.lower()]
        made = f"rockpulse {verb} {results} -o {plain.with_suffix(suffix)}"
        found = f"the name of {what}; {what} is made from a results file: {made}"
    elif plain.suffix.lower() in TEXTS:
        found = f"the suffix {plain.suffix} of another kind of file"
    if found:
        raise ResultsError(f"{path}: expected the name of a results file (HDF5), such as {results}, found {found}")


def _check_replaceable(target: Path, path: str | os.PathLike[str], overwrite: bool, kind: str) -> None:
    """Raise ResultsError if the target exists and is not a results file that may be replaced."""
    if not target.is_file():
        raise ResultsError(f"{path}: expected the name of a results file, found a folder or a device")
    if not overwrite:
        journal = journal_path(target)
        going_on = f"; --overwrite together with --resume continues the run of {journal}" if journal.exists() else ""
        raise ResultsError(
            f"{path}: the file exists; choose another name, or allow it to be replaced (--overwrite{going_on})",
            tells_resume=bool(going_on),
        )
    try:
        found = _kind(target)
    except OSError as error:
        raise ResultsError(f"{path}: cannot read the file that is to be replaced: {error.strerror}") from error
    if found is None:
        raise ResultsError(
            f"{path}: expected results of rockpulse, found another file, which is not replaced even with --overwrite; "
            "choose another name, or remove it by hand"
        )
    if found not in (kind, DAMAGED):
        raise ResultsError(
            f"{path}: expected {kind_in_words(kind)}, found {kind_in_words(found)}, which is not replaced "
            "even with --overwrite; choose another name, or remove it by hand"
        )


def _kind(target: Path) -> str | None:
    """Return the kind of a results file of any schema version; None if it is not a results file."""
    import h5py

    with target.open("rb") as file:
        if file.read(len(SIGNATURE)) != SIGNATURE:
            return None
    try:
        with h5py.File(target, "r", locking=False) as hdf5:  # a file that its writer has locked is not damaged
            ours = {"schema_version", "rockpulse_version"} <= set(hdf5.attrs)
            return str(hdf5.attrs.get("kind", ASSESSMENT)) if ours else None
    except (OSError, RuntimeError, KeyError):
        return DAMAGED


def flush(path: Path, mode: int) -> None:
    """Write a file or a folder from the buffers of the operating system to the disk."""
    handle = os.open(path, mode)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
