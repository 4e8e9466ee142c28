"""Finds scenarios by name or path, and applies changes given on the command line."""

import difflib
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import yaml

from tracked_bringup.node_table import NodeTable
from tracked_report.scenario import Scenario
from tracked_types.checked_yaml import CheckedFileError, check_content


class ArgumentError(ValueError):
    """An argument of the command line cannot be used; the text names it and what was expected."""


def scenario_names() -> list[str]:
    """Names of the packaged scenarios."""
    folder = resources.files("tracked_bringup") / "data" / "scenarios"
    return sorted(entry.name.removesuffix(".yaml") for entry in folder.iterdir() if entry.name.endswith(".yaml"))


def load_scenario(name_or_path: str, changes: Sequence[str], table: NodeTable) -> Scenario:
    """A packaged scenario by name, or a file by path, with changes such as ``duration_s:=20``.

    A change names a key of the scenario (``reference.parameters.radius_m:=0.8``) or a parameter of a node
    (``upper_nmpc.horizon:=12``); its value is read as YAML. A trajectory file or map that is not there is taken from
    the package, if it has one of that name (``routes/rooms.csv``, ``maps/rooms.yaml``).

    Raises
    ------
    ArgumentError: if there is no such scenario, or a change is malformed or names nothing known.
    CheckedFileError: if the scenario, changed as asked, does not keep its schema.
    """
    content, called = _read(name_or_path)
    for change in changes:
        _apply(content, change, table)
    scenario = _with_packaged_files(check_content(Scenario, content, called))
    _check_nodes(scenario, table, called)
    return scenario


def _read(name_or_path: str) -> tuple[dict[str, Any], str]:
    path = Path(name_or_path)
    if path.suffix in (".yaml", ".yml"):
        called = str(path)
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError) as error:
            raise CheckedFileError(f"{called}: cannot be read ({error})") from error
    else:
        if name_or_path not in scenario_names():
            raise ArgumentError(
                f"no scenario {name_or_path!r}; there are {', '.join(scenario_names())}, or give a .yaml file"
            )
        called = f"{name_or_path}.yaml"
        source = resources.files("tracked_bringup") / "data" / "scenarios" / called
        text = source.read_text(encoding="utf-8")
    try:
        content = yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise CheckedFileError(f"{called}: is not a YAML file ({error})") from error
    if not isinstance(content, dict):
        raise CheckedFileError(f"{called}: expected keys such as world and duration_s")
    return content, called


def split_change(change: str) -> tuple[str, Any]:
    """Key and YAML value of ``key:=value``.

    Raises
    ------
    ArgumentError: if it is not of that form.
    """
    key, separator, text = change.partition(":=")
    if not separator or not key:
        raise ArgumentError(f"expected key:=value, got {change!r}")
    try:
        return key, yaml.safe_load(text)
    except yaml.YAMLError as error:
        raise ArgumentError(f"{key}: {text!r} is not a value ({error})") from error


def _apply(content: dict[str, Any], change: str, table: NodeTable) -> None:
    key, value = split_change(change)
    first, *rest = key.split(".")
    path = [first, *rest]
    if first in table.nodes:
        if len(rest) != 1:
            raise ArgumentError(f"{key}: a node's parameter is given as {first}.PARAMETER:=VALUE")
        path = ["parameters", *path]
    elif first not in Scenario.model_fields:
        known = [*Scenario.model_fields, *table.nodes]
        near = difflib.get_close_matches(first, known, n=1)
        hint = f"did you mean {near[0]}?" if near else f"known are {', '.join(known)}"
        raise ArgumentError(f"{key} is neither a key of the scenario nor a node; {hint}")
    section = content
    for part in path[:-1]:
        inner = section.setdefault(part, {})
        if not isinstance(inner, dict):
            raise ArgumentError(f"{key}: {part} has no keys of its own")
        section = inner
    section[path[-1]] = value


def _with_packaged_files(scenario: Scenario) -> Scenario:
    update: dict[str, Any] = {}
    reference, map_server = scenario.reference, scenario.parameters.get("map_server", {})
    if reference is not None and reference.file is not None:
        update["reference"] = reference.model_copy(update={"file": _found_file(reference.file)})
    if isinstance(map_server.get("map"), str):
        changed = {**map_server, "map": _found_file(str(map_server["map"]))}
        update["parameters"] = {**scenario.parameters, "map_server": changed}
    return scenario.model_copy(update=update)


def _found_file(name: str) -> str:
    """``name`` as it is, or the packaged file of that name if there is only that."""
    packaged = Path(str(resources.files("tracked_bringup") / "data")) / name
    return str(packaged) if name and not Path(name).exists() and packaged.is_file() else name


def _check_nodes(scenario: Scenario, table: NodeTable, called: str) -> None:
    named: list[tuple[str, Mapping[str, Any]]] = [("nodes", scenario.nodes), ("parameters", scenario.parameters)]
    named += [(f"variants.{name}.parameters", variant.parameters) for name, variant in scenario.variants.items()]
    for section, nodes in named:
        for node in nodes:
            if node not in table.nodes:
                raise CheckedFileError(f"{called}: {section}.{node}: no such node; there are {', '.join(table.nodes)}")
