"""Coverage-guided fuzzing of the readers: inputs that reach new lines are kept and changed again (``make fuzz``).

Needs atheris (the extra "fuzz", Linux). The corpus grows in build/fuzz, from the samples and the committed inputs. An
input that breaks a promise is printed and written to build/fuzz/faults, and does not stop the run. ``--keep`` writes
the inputs that are needed for the coverage reached, the smallest ones, to tests/fuzz_corpus.tar.xz.
"""

import argparse
import hashlib
import re
import shutil
import subprocess
import sys
import warnings
from pathlib import Path

BUILD = Path(__file__).parents[1] / "build" / "fuzz"
GROWN, SMALLEST, FAULTS = BUILD / "corpus", BUILD / "minimised", BUILD / "faults"
#: The smallest inputs for the coverage reached are committed up to so many bytes, packed.
PACKED_LIMIT = 300_000


def _name(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]


def fuzz_here(arguments: list[str]) -> None:
    """Hand this process to libFuzzer with its own arguments; it does not return."""
    import atheris

    with atheris.instrument_imports(include=["rockpulse.readers"]):
        import fuzz_inputs

    def one(data: bytes) -> None:
        found = fuzz_inputs.fault(data)
        if found:
            path = FAULTS / _name(found.encode())
            if not path.exists():
                path.write_bytes(data)
                print(f"FAULT {path}\n{found}", flush=True)

    def change(data: bytes, longest: int, seed: int) -> bytes:
        if seed % 2 and len(data) > 1:
            return fuzz_inputs.mutated(data, seed)[:longest]
        return atheris.Mutate(data, longest)

    warnings.filterwarnings("ignore", module="obspy")
    # To merge, libFuzzer starts itself again by the shell, which takes the words of its first argument apart.
    atheris.Setup([f"{sys.executable} {__file__} --child", *arguments], one, custom_mutator=change)
    atheris.Fuzz()


def _child(*arguments: str | Path) -> str:
    """The output of libFuzzer in a process of its own."""
    command = [sys.executable, __file__, "--child", *map(str, arguments)]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    text = done.stdout.decode(errors="replace")
    if done.returncode:
        raise SystemExit(f"{' '.join(command)} ended with {done.returncode}:\n{text[-3000:]}")
    return text


def main() -> int:
    """Fuzz for some minutes, minimise the corpus, and print what was found."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--keep", action="store_true", help="write tests/fuzz_corpus.tar.xz")
    arguments = parser.parse_args()
    import fuzz_inputs

    for folder in (GROWN, FAULTS):
        folder.mkdir(parents=True, exist_ok=True)
    for data in [*fuzz_inputs.seeds(), *fuzz_inputs.kept_corpus()]:
        (GROWN / _name(data)).write_bytes(data)
    known = len(list(FAULTS.iterdir()))
    text = _child(f"-max_total_time={round(60.0 * arguments.minutes)}", f"-max_len={fuzz_inputs.LONGEST}", GROWN)
    edges, features = (re.findall(r"^#\d+\s.*?cov: (\d+) ft: (\d+)", text, re.MULTILINE) or [(0, 0)])[-1]
    runs = (re.findall(r"^Done (\d+) runs", text, re.MULTILINE) or [0])[-1]
    print(*(part for part in text.split("FAULT ")[1:]), sep="\n")
    # The inputs of the grown corpus that are needed for its coverage.
    shutil.rmtree(SMALLEST, ignore_errors=True)
    SMALLEST.mkdir(parents=True)
    _child("-merge=1", SMALLEST, GROWN)
    smallest = [path.read_bytes() for path in sorted(SMALLEST.iterdir())]
    faults = len(list(FAULTS.iterdir())) - known
    print(
        f"{runs} executions in {arguments.minutes:g} minutes, {edges} edges and {features} features of "
        f"rockpulse.readers covered, {len(smallest)} inputs of {sum(map(len, smallest))} bytes are enough for them, "
        f"{faults} faults"
    )
    if arguments.keep:
        size = fuzz_inputs.keep_corpus(smallest)
        print(f"{fuzz_inputs.CORPUS}: {size} bytes" + (", too large to be committed" if size > PACKED_LIMIT else ""))
    return min(faults, 1)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        fuzz_here(sys.argv[2:])
    sys.exit(main())
