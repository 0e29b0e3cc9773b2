"""``gearidae schema``: the JSON Schema of case files, for editors."""

from __future__ import annotations

import json
from pathlib import Path

import gearidae as gd
from gearidae.cli.codes import DONE
from gearidae.cli.output import say
from gearidae.errors import SceneError

__all__ = ["write_schema"]


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
    try:
        with output.open("w" if overwrite else "x", encoding="utf-8") as file:
            file.write(text + "\n")
    except FileExistsError:
        raise SceneError("schema", output, "exists already: allow --overwrite") from None
    except OSError as error:
        raise SceneError("schema", output, f"cannot be written ({error.strerror})") from error
    say(f"Schema: {output}")
    return DONE
