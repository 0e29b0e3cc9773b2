"""Commands of studies: their options are parameters of the study's function, and so are the words."""

import inspect
from collections.abc import Sequence

import pytest

import gearidae as gd
from gearidae.cli import study_commands
from gearidae.cli.session import app
from gearidae.cli.study_commands import _kind, _option
from gearidae.studies.declared import command_help, study_of_command


def question(
    scene,
    size: int,
    of: str | None = None,
    at: "float | Sequence[float]" = 0.5,
    marks: "Sequence[int]" = (1, 2),
):
    """Ask.

    Parameters
    ----------
    scene : Scene
        What is asked about.
    size : int
        Number of members; with `of`
        that of rows, in ``run.samples``, as for `at`.
    of : str, optional
        Figure.
    at : float or sequence of float, optional
        Time.
    marks : sequence of int, optional
        Marks.
    """


def arguments_of(command):
    """Options of a command by their names in Python."""
    collection = app[command].assemble_argument_collection()
    return {argument.names[0].removeprefix("--").replace("-", "_"): argument for argument in collection}


@pytest.mark.parametrize("command", command_help())
def test_an_option_is_a_parameter_of_the_function(command):
    """With its default and its words; every option of every study has words."""
    study, arguments = study_of_command(command), arguments_of(command)
    for path in study.options:
        other, _, name = path.rpartition(".")
        function = getattr(gd.studies, other or study.run or study.kind)
        default = inspect.signature(function).parameters[name].default
        assert arguments[name].field_info.default == default
    assert all(argument.parameter.help for name, argument in arguments.items() if name != "*")


def test_a_study_that_there_is_not_has_no_command():
    assert hasattr(study_commands, "hub_life")
    assert not hasattr(study_commands, "no_such_study")


def test_words_call_other_options_as_they_are_written():
    """What is no option of the command stays; lines of the docstring are joined."""
    option = _option(question, "size", ("size", "of"))
    assert option.annotation.__metadata__[0].help == (
        "Number of members; with --of that of rows, in ``run.samples``, as for `at`."
    )
    assert option.default is inspect.Parameter.empty


@pytest.mark.parametrize(
    ("name", "kind", "default"),
    [("of", str | None, None), ("at", float, 0.5), ("marks", list[int], (1, 2))],
)
def test_types_are_those_of_the_function(name, kind, default):
    """Of a number or several, the command line has one."""
    option = _option(question, name, ())
    assert (option.annotation.__origin__, option.default) == (kind, default)
    assert bool(option.annotation.__metadata__[0].consume_multiple) is (kind == list[int])


def test_words_to_choose_from_are_a_type():
    kind, many = _kind('Literal["sobol", "random"]')
    assert (kind.__args__, many) == (("sobol", "random"), False)
