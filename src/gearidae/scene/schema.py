"""The JSON Schema of a scene, by which editors complete and check case files."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic.json_schema import GenerateJsonSchema

from gearidae.scene.surface_library import COATINGS, SOLIDS

if TYPE_CHECKING:
    from gearidae.scene.scene import Scene

DIALECT = "https://json-schema.org/draft/2020-12/schema"

_GEAR_TABLES = ("gears", "mesh", "drive", "initial")
_TRAIN_TABLES = ("shafts", "meshes")


class _Schema(GenerateJsonSchema):
    """Leaves out the default of a list, which JSON has no tuple for."""

    ignored_warning_kinds = {"non-serializable-default"}  # noqa: RUF012  # as pydantic declares it


def json_schema(model: type[Scene]) -> dict[str, Any]:
    """Describe what a case file may hold.

    Types, limits, units and meanings are those of the scene's own fields. What no single key can say, for instance that
    flanks may not overlap at the start, is checked when the scene is made.

    Parameters
    ----------
    model : type of Scene

    Returns
    -------
    dict
        A JSON Schema (draft 2020-12). A quantity is a number in SI units or a text with a unit.
    """
    schema = model.model_json_schema(schema_generator=_Schema)
    _walk(schema)
    schema["properties"]["surface"] = {"anyOf": [schema["properties"]["surface"], _named_surfaces()]}
    schema["properties"]["$schema"] = {"type": "string", "description": "where this schema is"}
    return {
        "$schema": DIALECT,
        **schema,
        "title": "gearidae case file",
        "description": "One scene: a pair of gears, a train of shafts, or a roller. Numbers are in SI units.",
        "oneOf": [
            {"required": list(_GEAR_TABLES), "not": _any_of("roller", *_TRAIN_TABLES)},
            {"required": [*_TRAIN_TABLES, "drive", "initial"], "not": _any_of("roller", "gears")},
            {"required": ["roller"], "not": _any_of(*_GEAR_TABLES, *_TRAIN_TABLES, "load")},
        ],
    }


def _any_of(*tables: str) -> dict[str, Any]:
    return {"anyOf": [{"required": [table]} for table in tables]}


def _named_surfaces() -> dict[str, Any]:
    names = [f"{solid}{coating}" for solid in SOLIDS for coating in ("", *(f", {name}" for name in COATINGS))]
    return {"type": "string", "examples": names, "description": "a surface of the library, by its name"}


def _walk(schema: Any) -> None:
    """Fit pydantic's schema to a case file, which has no null, and may give one entry for a list of one."""
    if isinstance(schema, list):
        for part in schema:
            _walk(part)
    if not isinstance(schema, dict):
        return
    for part in schema.values():
        _walk(part)
    choices = schema.get("anyOf", [])
    if {"type": "null"} in choices:
        kept = [choice for choice in choices if choice != {"type": "null"}]
        del schema["anyOf"]
        if schema.get("default", 0) is None:
            del schema["default"]
        schema |= kept[0] if len(kept) == 1 else {"anyOf": kept}
    items = schema.get("items")
    if schema.get("type") == "array" and isinstance(items, dict) and ("$ref" in items or "anyOf" in items):
        schema["anyOf"] = [{"type": "array", "items": schema.pop("items")}, dict(items)]
        del schema["type"]
