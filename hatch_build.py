"""The entry points of the distribution that make the formats plugins of obspy; hatchling calls this file at a build.

``obspy.read`` finds a plugin by two kinds of entry points: the format by its name, and its two functions. The modules
of the formats are parsed, not imported, because nothing that they import is there when a package is built.
"""

import ast
from pathlib import Path

from hatchling.metadata.plugin.interface import MetadataHookInterface

FORMATS = Path(__file__).parent / "pipeline" / "rockpulse" / "readers" / "formats"
GROUP = "obspy.plugin.waveform"
PLUGIN = "rockpulse.readers.obspy_plugin"


def plugin_names(folder: Path = FORMATS) -> list[str]:
    """The names of the formats that are read, in upper case, without those that obspy reads itself."""
    found = []
    for path in sorted(folder.glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Format":
                row = {word.arg: word.value.value for word in node.keywords if isinstance(word.value, ast.Constant)}
                if "name" in row and row["unit"] != "-" and not row.get("obspy_reads", False):
                    found.append(row["name"].upper())
    return found


def entry_points(folder: Path = FORMATS) -> dict[str, dict[str, str]]:
    """The entry points by their groups."""
    names = plugin_names(folder)
    functions = {
        f"{GROUP}.{name}": {"isFormat": f"{PLUGIN}:{name}.is_format", "readFormat": f"{PLUGIN}:{name}.read_format"}
        for name in names
    }
    return {GROUP: dict.fromkeys(names, PLUGIN), **functions}


class EntryPoints(MetadataHookInterface):
    """What hatchling calls for the fields that pyproject.toml names as dynamic."""

    def update(self, metadata: dict) -> None:
        """Add the entry points to the metadata of the distribution."""
        metadata["entry-points"] = entry_points()
