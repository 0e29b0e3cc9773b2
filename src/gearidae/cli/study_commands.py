"""The commands of studies, made from their functions when the command line asks for one by its name.

Options are parameters of the study's function: their types, defaults and words, which cyclopts reads from its numpydoc.
What is written otherwise on the command line is declared beside it.
"""

from __future__ import annotations

import ast
import inspect
import operator
import re
from collections.abc import Callable, Iterable
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, Annotated, Any, Final, Literal, get_args

from cyclopts import App, Parameter
from docstring_parser import DocstringStyle, parse

import gearidae as gd
from gearidae.cli import completing
from gearidae.cli.app import Case, Dask, Json, Output, Overwrite, Settings
from gearidae.cli.examples import epilogue
from gearidae.studies.declared import command_help, study_of_command
from gearidae.studies.study import Option, Study

if TYPE_CHECKING:
    from concurrent.futures import Executor


_WORTH_PROCESSES: Final = 64
"""Members from which on it is worth while to start processes, which takes some seconds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """How a study is computed and kept; each field is an option."""

    output: Output = None
    settings: Settings = None
    jobs: Annotated[int | None, Parameter(help="Number of simultaneous runs. Default: one per core.")] = None
    dask: Dask = None
    resume: Annotated[bool, Parameter(help="Resume the unfinished study in the output file.")] = False
    overwrite: Overwrite = False
    as_json: Json = False

    def executor(self, keys: Iterable[str] = (), members: int = 0) -> AbstractContextManager[Executor | None]:
        """Provide the executor of a cluster, or of processes where many members have tables of their own.

        Parameters
        ----------
        keys, members
            What differs between the members of an ensemble, and how many they are.
        """
        from gearidae.runs.executors import check_jobs, dask_executor, own_executor

        own_tables = any(key.startswith("surface.") or key == "coating.energy" for key in keys)
        if self.dask is None and own_tables and members >= _WORTH_PROCESSES:
            return own_executor(check_jobs(self.jobs), members, releases_gil=False)
        return dask_executor(self.dask)


_USUAL = Request()


_KINDS: Final = {"int": int, "float": float, "str": str, "bool": bool, "None": None}
_LISTS: Final = {"Sequence[int]": list[int], "Sequence[str]": list[str]}
"""Types of parameters that are options as they are; of ``int | Sequence[int]`` the command line has the first."""
_NAME: Final = re.compile(r"(?<!`)`(\w+)`(?!`)")
"""What the words of a function call another parameter."""


def __getattr__(name: str) -> App:
    """Make the command of a study; ``-`` in its name is ``_`` here."""
    command = name.replace("_", "-")
    if command not in command_help():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    study = study_of_command(command)
    app = App(name=command, help=command_help()[command], help_epilogue=epilogue(study.examples))
    app.default(_function(study))
    return app


def _function(study: Study) -> Any:
    """Make the function of a command: its options are parameters of the study's function, and those of all studies."""
    function = getattr(gd.studies, study.run or study.kind)
    written = inspect.signature(study.command, eval_str=True).parameters if study.command is not dict else {}

    options = [_option(function, name, {*written, *study.options}) for name in study.options]
    defaults = {option.name: option.default for option in options if option.default is not option.empty}

    def run(case: Any, *, request: Request = _USUAL, **given: Any) -> int:
        from gearidae.cli.studies import run_study

        arguments = study.command(**{name: given.pop(name) for name in written if name in given})
        return run_study(study, function, str(case), request, {**defaults, **arguments, **given})

    parameters = [
        inspect.Parameter("case", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=Case),
        *(parameter.replace(annotation=_annotation(parameter.annotation)) for parameter in written.values()),
        *options,
        inspect.Parameter(
            "request",
            inspect.Parameter.KEYWORD_ONLY,
            default=_USUAL,
            annotation=Annotated[Request, Parameter(name="*")],
        ),
    ]
    run.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
    return run


def _option(function: Callable[..., Any], path: str, options: Iterable[str]) -> inspect.Parameter:
    """Make an option of a parameter of a function, or of the one of `gearidae.studies` that stands before its name."""
    other, _, name = path.rpartition(".")
    owner = getattr(gd.studies, other) if other else function
    parameter = inspect.signature(owner).parameters[name]
    declared = parameter.annotation
    kind, many = _kind(declared if isinstance(declared, str) else inspect.formatannotation(declared))
    numpydoc = parse(inspect.getdoc(owner) or "", DocstringStyle.NUMPYDOC)
    words = {entry.arg_name: entry.description for entry in numpydoc.params}
    names = {known.rpartition(".")[2] for known in options}
    help_ = _NAME.sub(lambda found: f"--{found[1]}" if found[1] in names else found[0], words[name] or "")
    return parameter.replace(
        kind=inspect.Parameter.KEYWORD_ONLY,
        annotation=Annotated[kind, Parameter(help=" ".join(help_.split()), consume_multiple=many)],
    )


def _kind(annotation: str) -> tuple[Any, bool]:
    """Type of an option, and whether several values follow it."""
    if annotation.startswith("Literal["):
        return Literal[ast.literal_eval(f"({annotation[8:-1]},)")], False
    parts = annotation.split(" | ")
    plain = [_KINDS[part] for part in parts if part in _KINDS]
    lists = [_LISTS[part] for part in parts if part in _LISTS]
    many = bool(lists) and plain in ([], [None])
    return reduce(operator.or_, [*lists, *plain] if many else plain), many


def _annotation(declared: Any) -> Any:
    """Turn the annotation of a parameter with its `Option` into one that cyclopts reads."""
    kind, option = get_args(declared)
    assert isinstance(option, Option)
    about: dict[str, Any] = {"help": option.help}
    if option.repeatable or option.many:
        about["consume_multiple"] = option.many
    if option.completes:
        about["completer"] = getattr(completing, option.completes)
    return Annotated[kind, Parameter(**about)]
