"""Options that the commands of all studies have."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

from cyclopts import Parameter

from gearidae.cli.app import Dask, Output, Overwrite, Settings

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
