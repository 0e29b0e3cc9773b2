"""Publications that a result rests on: as text for a list of references, and as entries for BibTeX."""

from __future__ import annotations

import re
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Reference:
    """A publication, or a program.

    Attributes
    ----------
    key : str
        By which a text cites it.
    authors : tuple of str
        Initials and name: ``"K. L. Johnson"``.
    title : str
    year : int
        0 of a program without a date.
    journal : str, optional
        Without one it is a book or a program.
    volume, pages, publisher, version : str, optional
        ``version`` of a program.
    doi : str, optional
    """

    key: str
    authors: tuple[str, ...]
    title: str
    year: int
    journal: str = ""
    volume: str = ""
    pages: str = ""
    publisher: str = ""
    version: str = ""
    doi: str = ""

    @property
    def source(self) -> str:
        """Authors, journal and pages without the title: ``K. L. Johnson, Journal 1 (1971) 1-2, doi:10.1/2``."""
        return ", ".join(filter(None, (_listed(self.authors), self._place(), self.doi and f"doi:{self.doi}")))

    @property
    def text(self) -> str:
        """The whole of it as a line."""
        link = f"https://doi.org/{self.doi}" if self.doi else ""
        return ", ".join(filter(None, (_listed(self.authors), self.title, self._place(), link)))

    @property
    def bibtex(self) -> str:
        """An entry for BibTeX, with braces around the title's capital letters."""
        kind = "article" if self.journal else "book" if self.publisher else "misc"
        fields = {
            "author": " and ".join(self.authors),
            "title": re.sub(r"(\w*[A-Z]\w*)", r"{\1}", self.title),
            "journal": self.journal,
            "volume": self.volume,
            "pages": self.pages.replace("-", "--"),
            "publisher": self.publisher,
            "year": str(self.year or ""),
            "note": f"Computer software, version {self.version}" if self.version else "",
            "doi": self.doi,
        }
        lines = ",\n".join(f"  {name} = {{{value}}}" for name, value in fields.items() if value)
        return f"@{kind}{{{self.key},\n{lines}\n}}"

    def _place(self) -> str:
        """Where it appeared: journal, volume, year and pages; of a book its publisher, of a program its version."""
        if self.journal:
            return f"{self.journal} {self.volume} ({self.year}) {self.pages}"
        version = f"version {self.version}" if self.version else ""
        return ", ".join(filter(None, (self.publisher, version, str(self.year or ""))))


def _listed(authors: tuple[str, ...]) -> str:
    """Names in a row."""
    return ", ".join(authors)


TEODORESCU_2009 = Reference(
    "teodorescu2009",
    ("M. Teodorescu", "S. Theodossiades", "H. Rahnejat"),
    "Impact dynamics of rough and surface protected MEMS gears",
    2009,
    "Tribology International",
    "42",
    "197-205",
    doi="10.1016/j.triboint.2008.05.019",
)
"""The model's paper."""
GREENWOOD_WILLIAMSON_1966 = Reference(
    "greenwood1966",
    ("J. A. Greenwood", "J. B. P. Williamson"),
    "Contact of nominally flat surfaces",
    1966,
    "Proceedings of the Royal Society A",
    "295",
    "300-319",
    doi="10.1098/rspa.1966.0242",
)
"""Asperities of Gaussian heights."""
FULLER_TABOR_1975 = Reference(
    "fuller1975",
    ("K. N. G. Fuller", "D. Tabor"),
    "The effect of surface roughness on the adhesion of elastic solids",
    1975,
    "Proceedings of the Royal Society A",
    "345",
    "327-342",
    doi="10.1098/rspa.1975.0138",
)
"""Asperities of Gaussian heights that adhere."""
GIRIFALCO_GOOD_1957 = Reference(
    "girifalco1957",
    ("L. A. Girifalco", "R. J. Good"),
    "A theory for the estimation of surface and interfacial energies. I. Derivation and application to interfacial "
    "tension",
    1957,
    "Journal of Physical Chemistry",
    "61",
    "904-909",
    doi="10.1021/j150553a013",
)
"""The energy of two unlike faces."""
JOHNSON_1985 = Reference(
    "johnson1985",
    ("K. L. Johnson",),
    "Contact Mechanics",
    1985,
    publisher="Cambridge University Press",
    doi="10.1017/CBO9781139171731",
)
"""Deflection of bodies."""
HINDMARSH_2005 = Reference(
    "hindmarsh2005",
    (
        "A. C. Hindmarsh", "P. N. Brown", "K. E. Grant", "S. L. Lee", "R. Serban", "D. E. Shumaker", "C. S. Woodward",
    ),
    "SUNDIALS: Suite of nonlinear and differential/algebraic equation solvers",
    2005,
    "ACM Transactions on Mathematical Software",
    "31",
    "363-396",
    doi="10.1145/1089014.1089020",
)  # fmt: skip
"""The solver."""
RANDALL_2024 = Reference(
    "randall2024",
    ("C. R. Randall",),
    "scikit-SUNDAE: A scikit with Python bindings to SUNDIALS Differential Algebraic Equation solvers",
    2024,
    doi="10.11578/dc.20241104.3",
)
"""The way from Python to the solver."""
GARCIA_SNIEGOWSKI_1995 = Reference(
    "garcia1995",
    ("E. J. Garcia", "J. J. Sniegowski"),
    "Surface micromachined microengine",
    1995,
    "Sensors and Actuators A",
    "48",
    "203-214",
)
"""The drive of a microengine."""
ARCHARD_1953 = Reference(
    "archard1953",
    ("J. F. Archard",),
    "Contact and rubbing of flat surfaces",
    1953,
    "Journal of Applied Physics",
    "24",
    "981-988",
    doi="10.1063/1.1721448",
)
"""Wear by sliding."""
FOUVRY_2003 = Reference(
    "fouvry2003",
    ("S. Fouvry", "T. Liskiewicz", "Ph. Kapsa", "S. Hannel", "E. Sauger"),
    "An energy description of wear mechanisms and its applications to oscillating sliding contacts",
    2003,
    "Wear",
    "255",
    "287-298",
    doi="10.1016/S0043-1648(03)00117-0",
)
"""Wear by energy."""
