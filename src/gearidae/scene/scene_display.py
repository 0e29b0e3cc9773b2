"""A scene as people see it: in one line, or as a table in a notebook."""

from __future__ import annotations

import html
import math
from collections.abc import Iterator, Mapping
from typing import Any, Final

from gearidae.scene.display import as_html, as_line
from gearidae.scene.prefixes import with_prefix
from gearidae.scene.presets import PRESETS, preset
from gearidae.scene.scene import Scene, describe_key

_NEAR: Final = 12
"""Keys in which a scene may differ from a preset that it is compared with."""
_NAMED: Final = 3
"""Differences that a line names."""
_PREFIXED: Final = ("m", "s", "N", "J", "Pa", "Hz", "W")
"""Units that take a prefix where a text begins with them."""


@as_line.register
def _line(scene: Scene) -> str:
    """Write what a scene is in one line.

    Returns
    -------
    str
        Such as ``<Scene 'worn': gears 19:76, SAM 50 %, 300 ms; teodorescu2009_low_speed, but ...>``.
    """
    gears, roller = scene.gears, scene.roller
    if gears is not None:
        what = f"gears {gears.pinion_teeth}:{gears.gear_teeth}"
    elif roller is None:
        what = f"train of {len(scene.train.shafts)} shafts, {len(scene.train.meshes)} meshes"
    else:
        what = f"roller of {with_prefix(roller.radius, 'm')}"
    parts = [what, f"SAM {_covered(scene)} %", with_prefix(scene.run.duration, "s")]
    name = nearest_preset(scene)
    if name:
        changed = differences(scene, name)
        listed = [
            f"no {key}" if new is None else f"{key} = {value_text(key, new)}"
            for key, (_, new) in list(changed.items())[:_NAMED]
        ]
        more = [f"{len(changed) - _NAMED} more"] if len(changed) > _NAMED else []
        parts.append(f"as {name}" + (f" but {', '.join([*listed, *more])}" if changed else ""))
    return f"<Scene {scene.name!r}: {', '.join(parts)}>"


def _covered(scene: Scene) -> str:
    """Covered share in percent, of both sides where they are covered independently."""
    coating = scene.coating
    shares = coating.fractions if coating.pairing == "independent" else coating.fractions[:1]
    return " and ".join(f"{100.0 * share:.4g}" for share in shares)


@as_html.register
def _table(scene: Scene) -> str:
    """Write a scene as an HTML table of its keys, those that differ from the nearest preset marked.

    Returns
    -------
    str
        Without colours of its own, so that it can be read on any background.
    """
    name = nearest_preset(scene)
    changed = differences(scene, name) if name else {}
    caption = f"<b>{html.escape(scene.name)}</b>"
    if name:
        many = (
            f"{len(changed)} {'key differs' if len(changed) == 1 else 'keys differ'}"
            if changed
            else "nothing differs"
        )
        caption += f" compared with the preset {name}: {many}"
    rows = []
    table = ""
    for key, value in flat(scene.to_dict()).items():
        section, _, last = key.partition(".")
        if last and section != table:
            table = section
            rows.append(f'<tr><th colspan="3" style="text-align: left">{html.escape(section)}</th></tr>')
        if last:
            rows.append(_row(key, last, value, changed.get(key)))
    gone = [(key, old) for key, (old, new) in changed.items() if new is None]
    rows += [_row(key, key, None, (old, None)) for key, old in gone]
    return f"<table><caption style='text-align: left'>{caption}</caption>{''.join(rows)}</table>"


def _row(key: str, name: str, value: object, change: tuple[object, object] | None) -> str:
    shown = "-" if value is None else value_text(key, value)
    remark = ""
    if change is not None:
        old = "not there" if change[0] is None else value_text(key, change[0])
        shown, remark = f"<b>{html.escape(shown)}</b>", html.escape(f"preset: {old}")
    else:
        shown = html.escape(shown)
    cells = (html.escape(name), shown, remark)
    return f"<tr>{''.join(f'<td style=text-align:left>{cell}</td>' for cell in cells)}</tr>"


def nearest_preset(scene: Scene) -> str:
    """Name the preset that a scene differs least from; empty if none is near.

    Returns
    -------
    str
        The preset of the scene's own name, if there is one of the same kind.
    """
    if scene.gears is None and scene.roller is None:
        return ""  # a train
    same = [name for name in PRESETS if ("roller" in PRESETS[name]) == (scene.roller is not None)]
    if scene.name in same:
        return scene.name
    counts = {name: len(differences(scene, preset(name).name)) for name in same}
    best = min(counts, key=lambda name: counts[name])
    return best if counts[best] <= _NEAR else ""


def differences(scene: Scene, name: str) -> dict[str, tuple[object, object]]:
    """List the keys in which a scene differs from a preset.

    Parameters
    ----------
    name : str
        Of the preset.

    Returns
    -------
    dict of str to tuple
        Dotted key to the values in the preset and in the scene; None where there is none.
    """
    old, new = flat(preset(name).to_dict()), flat(scene.to_dict())
    keys = [*new, *(key for key in old if key not in new)]
    return {
        key: (old.get(key), new.get(key)) for key in keys if key != "name" and old.get(key) != new.get(key)
    }


def flat(tables: Mapping[str, Any]) -> dict[str, object]:
    """List the values of nested tables by their dotted keys; a list of pairs or of numbers is one value."""
    return dict(_walk(tables, ""))


def _walk(inside: Any, key: str) -> Iterator[tuple[str, object]]:
    if isinstance(inside, Mapping):
        for name, value in inside.items():
            yield from _walk(value, f"{key}.{name}".lstrip("."))
    elif isinstance(inside, (list, tuple)) and inside and isinstance(inside[0], Mapping):
        for number, value in enumerate(inside):
            yield from _walk(value, f"{key}.{number}")
    elif not (isinstance(inside, (list, tuple)) and not inside):
        yield key, inside


def value_text(key: str, value: object) -> str:
    """Write a value with its unit, and a prefix where that helps.

    Parameters
    ----------
    key : str
        Dotted key, which determines the unit.
    value : object
        In SI.
    """
    if isinstance(value, (list, tuple)):
        return _list(key, value)
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value)
    unit = describe_key(key).unit
    if unit == "rad":
        return f"{math.degrees(value):.6g} deg"
    if unit in ("", "1"):
        return f"{value:.9g}"
    if unit.split(" ")[0].split("/")[0].split("^")[0] in _PREFIXED and unit != "rad/s":
        return with_prefix(value, unit, 6)
    return f"{value:.6g} {unit}"


def _list(key: str, value: list[Any] | tuple[Any, ...]) -> str:
    if key.startswith("contact.asperities."):
        return f"{len(value)} cells"
    if key.endswith("_pitch_error"):
        return f"{len(value)} teeth, {with_prefix(min(value), 'm')} to {with_prefix(max(value), 'm')}"
    if value and isinstance(value[0], (list, tuple)) and key.endswith("_table"):
        return f"{len(value)} rows of {len(value[0])}"
    if value and isinstance(value[0], (list, tuple)):
        first, last = value[0][0], value[-1][0]
        return f"{len(value)} knots from {with_prefix(first, 's')} to {with_prefix(last, 's')}"
    return ", ".join(f"{number:.6g}" for number in value)
