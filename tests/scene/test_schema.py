"""The JSON schema of case files says what scenes accept: keys, units, limits, meanings, tables that go together."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

import pytest

import gearidae as gd
from gearidae.cli import main
from gearidae.scene import PRESETS, Scene, dump_case
from gearidae.scene.named_tables import NAME

SCHEMA = Scene.json_schema()


def resolve(node):
    """The schema of a node; of a table that may be named instead, that of the table."""
    node = (
        next((branch for branch in node.get("anyOf", []) if "$ref" in branch), node)
        if "$ref" not in node
        else node
    )
    return SCHEMA["$defs"][node["$ref"].rpartition("/")[2]] if "$ref" in node else node


def at(key):
    """The schema of a dotted key."""
    node = SCHEMA
    for part in key.split("."):
        node = resolve(node)
        if part == NAME:
            node = node["additionalProperties"]
            continue
        if "anyOf" in node and "properties" not in node:
            node = next(resolve(branch) for branch in node["anyOf"] if "$ref" in branch)
        node = node["properties"][part]
    return node


@pytest.mark.parametrize("info", gd.describe_keys(), ids=lambda info: info.key)
def test_every_key_has_its_meaning_unit_and_limits(info):
    if info.key.endswith(f"gears.{NAME}"):
        assert at(info.key) == {"type": "integer", "minimum": 3, "maximum": 10_000}
        return
    node = at(info.key)
    assert node["description"] == info.description
    if info.unit and "." in info.key and not info.allowed.startswith(("a whole", "a list", "a table")):
        number, text = node["anyOf"][:2]
        assert (number["type"], text["type"]) == ("number", "string")
        assert number["description"] == info.unit
        if " in " in f" {info.allowed}" and ".." in info.allowed:
            assert f"{number['minimum']:g}..{number['maximum']:g}" in info.allowed
    table = info.key.rpartition(".")[0]
    if table:
        assert (info.key.rpartition(".")[2] in resolve(at(table)).get("required", [])) == info.required or (
            "anyOf" in at(table)
        )


def test_no_key_is_described_that_scenes_do_not_know():
    known = {info.key for info in gd.describe_keys()}

    def keys(node, prefix):
        for name, inner in node.get("properties", {}).items():
            yield f"{prefix}{name}", inner
            yield from keys(resolve(inner), f"{prefix}{name}.")
            for branch in inner.get("anyOf", []):
                yield from keys(resolve(branch), f"{prefix}{name}.") if "$ref" in branch else ()
            if "$ref" in (entry := inner.get("additionalProperties") or {}):
                yield from keys(resolve(entry), f"{prefix}{name}.{NAME}.")

    described = {key for key, _ in keys(SCHEMA, "")}
    tables = set(Scene.model_fields)
    assert described - tables - {"$schema"} == known - tables - {"shafts.NAME.gears.NAME"}
    for name, definition in SCHEMA[
        "$defs"
    ].items():  # a torque law's parameters have the names that it gives them
        assert definition["additionalProperties"] is (name == "Law")


def test_a_scene_has_gears_or_a_roller():
    gears, train, roller = SCHEMA["oneOf"]
    assert set(gears["required"]) == {"gears", "mesh", "drive", "initial"}
    assert set(train["required"]) == {"shafts", "meshes", "drive", "initial"}
    assert roller["required"] == ["roller"]
    assert set(SCHEMA["required"]) == {"surface", "run"}


def test_case_files_have_no_null():
    assert '"null"' not in json.dumps(SCHEMA)


def test_choices_are_those_of_today():
    assert at("contact.bodies")["enum"] == ["auto", "rigid", "elastic"]
    assert at("contact.roughness")["enum"] == ["statistical", "discrete"]
    assert "maugis" in at("contact.asperity")["enum"]


@pytest.mark.parametrize("line", ["#:schema gearidae.schema.json", '"$schema" = "gearidae.schema.json"'])
def test_a_case_file_may_name_its_schema(tmp_path, line):
    path = tmp_path / "case.toml"
    path.write_text(f"{line}\n{dump_case(gd.preset('roller_slow'))}")
    assert gd.load_case(path) == gd.preset("roller_slow")


def test_the_command(tmp_path, capsys):
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == SCHEMA
    target = tmp_path / "schema.json"
    assert main(["schema", "-o", str(target)]) == 0
    assert json.loads(target.read_text()) == SCHEMA
    assert main(["schema", "-o", str(target)]) == 2
    assert main(["schema", "-o", str(target), "--overwrite"]) == 0
    assert main(["schema", "-o", str(tmp_path / "none" / "schema.json")]) == 2


def test_presets_name_known_keys_only():
    """What the schema forbids no preset holds; the limits are tested key by key."""
    for name in PRESETS:
        for table, content in gd.preset(name).to_dict().items():
            if isinstance(content, dict):
                assert set(content) <= set(resolve(at(table))["properties"])


@pytest.fixture(scope="module")
def validator():
    return pytest.importorskip("jsonschema").Draft202012Validator(SCHEMA)


CASES = sorted((Path(__file__).parents[2] / "cases").glob("*.toml"))


@pytest.mark.parametrize("case", CASES, ids=lambda path: path.stem)
def test_every_shipped_case_is_valid(case, validator):
    assert not list(validator.iter_errors(tomllib.loads(case.read_text())))


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_is_valid(name, validator):
    assert not list(validator.iter_errors(tomllib.loads(dump_case(gd.preset(name)))))


@pytest.mark.parametrize("key", ["drive.speed", "drive.schedule", "load.schedule"])
def test_schedules_are_pairs_or_a_table(key, validator):
    table, _, name = key.partition(".")
    case = tomllib.loads(dump_case(gd.preset("teodorescu2009_low_speed")))
    for schedule in ([[0, 1], ["5 ms", 2]], {"file": "x.csv", "time": "t [s]"}, {"knots": [[0, 1]]}):
        assert validator.is_valid({**case, table: {**case.get(table, {}), name: schedule}})
    for wrong in ([[0, 1, 2]], [[True, 1]], True):
        assert not validator.is_valid({**case, table: {**case.get(table, {}), name: wrong}})
