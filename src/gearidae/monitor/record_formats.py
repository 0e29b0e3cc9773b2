"""Records in files that are no text: those of MATLAB, numpy, spreadsheets and LabVIEW, read by libraries for them."""

from __future__ import annotations

import gzip
import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final
from zipfile import BadZipFile

import numpy as np

if TYPE_CHECKING:
    import pandas as pd

_MOST: Final = 2**31
"""Bytes that a compressed file may have when it is unpacked."""


def frame_from(source: Path) -> pd.DataFrame | None:
    """Read the columns of a file that is no text.

    Parameters
    ----------
    source : Path

    Returns
    -------
    DataFrame or None
        Columns by the names that the file has, or ``column 1`` and so on; None of a file that is read as text.

    Raises
    ------
    ValueError
        If it cannot be read, or the library for it is not installed.
    """
    read = _READERS.get(source.suffix.lower())
    if read is None:
        return None
    try:
        frame = read(source)
    except ImportError as error:
        library = _LIBRARIES.get(source.suffix.lower(), error.name)
        raise ValueError(
            f"is read with {library}, which is not installed: pip install {library}, or save it as CSV"
        ) from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile) as error:
        raise ValueError(f"cannot be read as a {source.suffix.lower()} file ({error})") from None
    if frame.empty:
        raise ValueError("holds no columns of numbers")
    return frame


@contextmanager
def unpacked(source: Path) -> Iterator[Path]:
    """Unpack a file that is compressed with gzip, as long as the block lasts; any other is given as it is."""
    if source.suffix.lower() != ".gz":
        yield source
        return
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / source.stem
        try:
            with gzip.open(source) as packed, target.open("wb") as file:
                while chunk := packed.read(2**20):
                    file.write(chunk)
                    if file.tell() > _MOST:
                        raise ValueError(
                            f"is larger than {_MOST / 1e9:.3g} GB when it is unpacked: shorten it"
                        )
        except (OSError, EOFError) as error:
            raise ValueError(f"cannot be unpacked ({error})") from None
        yield target


def _from_matlab(source: Path) -> pd.DataFrame:
    from scipy.io import loadmat

    try:
        content = loadmat(source, squeeze_me=True)
    except NotImplementedError:
        raise ValueError("version 7.3 is not read: save it with the option -v7") from None
    return _of_columns({name: array for name, array in content.items() if not name.startswith("__")})


def _from_numpy(source: Path) -> pd.DataFrame:
    array = np.load(source, allow_pickle=False)
    if array.dtype.names is not None:
        return _of_columns({name: array[name] for name in array.dtype.names})
    if array.ndim not in (1, 2):
        raise ValueError(f"has {array.ndim} dimensions: rows and columns are wanted")
    table = array.reshape(len(array), -1)
    return _of_columns({f"column {k + 1}": table[:, k] for k in range(table.shape[1])})


def _of_columns(arrays: Mapping[str, Any]) -> pd.DataFrame:
    """Put the longest arrays of one dimension side by side; a table among them by its columns."""
    import pandas as pd

    columns = {}
    for name, array in arrays.items():
        values = np.asarray(array)
        if values.dtype.kind not in "fiuMm":
            continue
        if values.ndim == 1:
            columns[name] = values
        elif values.ndim == 2:
            columns |= {f"{name} {k + 1}": values[:, k] for k in range(values.shape[1])}
    longest = max(map(len, columns.values()), default=0)
    return pd.DataFrame({name: values for name, values in columns.items() if len(values) == longest})


def _from_spreadsheet(source: Path) -> pd.DataFrame:
    import pandas as pd

    frame: pd.DataFrame = pd.read_excel(source)
    return frame


def _from_tdms(source: Path) -> pd.DataFrame:
    from nptdms import TdmsFile

    frame: pd.DataFrame = TdmsFile.read(source).as_dataframe()
    return frame.rename(columns=lambda path: str(path).rpartition("/")[2].strip("'"))


_READERS: Final[Mapping[str, Callable[[Path], pd.DataFrame]]] = {
    ".mat": _from_matlab,
    ".npy": _from_numpy,
    ".xlsx": _from_spreadsheet,
    ".xls": _from_spreadsheet,
    ".tdms": _from_tdms,
}
_LIBRARIES: Final = {".xlsx": "openpyxl", ".xls": "xlrd", ".tdms": "npTDMS"}
