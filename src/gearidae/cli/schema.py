"""``gearidae schema``: the JSON Schema of case files, for editors."""

from __future__ import annotations

import json
from pathlib import Path

import gearidae as gd
from gearidae.archive.target import whole_file
from gearidae.cli.codes import DONE
from gearidae.cli.output import say


def write_schema(output: Path | None, *, overwrite: bool) -> int:
    """Print the JSON Schema of case files, or write it to a file.

    Parameters
    ----------
    output : Path or None
        File to write; None to print it.
    overwrite : bool
        Whether the file may be replaced.

    Returns
    -------
    int
        Exit code.

    Raises
    ------
    SceneError
        If the file exists or cannot be written.
    """
    text = json.dumps(gd.Scene.json_schema(), indent=2)
    if output is None:
        say(text)
        return DONE
    with whole_file(output, overwrite=overwrite, name="schema", remedy="allow --overwrite") as part:
        part.write_text(text + "\n", encoding="utf-8")
    say(f"Schema: {output}")
    return DONE
