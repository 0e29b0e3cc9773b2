"""The commands of studies, made from their declarations when the command line asks for one by its name."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final, get_args

from cyclopts import App, Parameter

from gearidae.cli import completing
from gearidae.cli.app import Case, Dask, Json, Output, Overwrite, Settings
from gearidae.cli.examples import epilogue
from gearidae.studies.declared import study_of_command
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

    def executor(
        self, keys: Mapping[str, Any] | Sequence[str] = (), members: int = 0
    ) -> AbstractContextManager[Executor | None]:
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


def __getattr__(name: str) -> App:
    """Make the command of a study; ``-`` in its name is ``_`` here."""
    if name.startswith("__"):
        raise AttributeError(name)
    command = name.replace("_", "-")
    study = study_of_command(command)
    app = App(name=command, help_epilogue=epilogue(study.examples))
    app.default(_function(study))
    return app


def _function(study: Study) -> Any:
    """Make the function of a command: its options are the parameters of the study's, and those of all studies."""
    assert study.command is not None
    made = study.command

    def run(case: Any, *, request: Request = _USUAL, **options: Any) -> int:
        from gearidae.cli.studies import run_study

        return run_study(study, str(case), request, made(**options))

    parameters = [
        inspect.Parameter("case", inspect.Parameter.POSITIONAL_OR_KEYWORD, annotation=Case),
        *(
            parameter.replace(annotation=_annotation(parameter.annotation))
            for parameter in inspect.signature(made, eval_str=True).parameters.values()
        ),
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
