"""Specification files: YAML with a system and one thing that is asked of it."""

from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

from robust_core.command_line.fields import Fields, SpecError
from robust_core.errors import MissingDependencyError

TASKS = ("stabilise", "filter", "observer", "certify", "map")
COMMAND_OF = {"stabilise": "design", "filter": "design", "observer": "design", "certify": "certify", "map": "map"}
_LARGEST_FILE = 1_000_000


@dataclass(frozen=True, slots=True)
class Spec:
    """``name`` of the outputs, the ``system``, and the ``task`` with what is ``asked``."""

    name: str
    about: str
    system: Fields
    task: str
    asked: Fields


def examples() -> list[str]:
    """Names of the specifications that come with the package."""
    return sorted(item.name for item in _folder().iterdir() if item.name.endswith(".yaml"))


def read_spec(path: str) -> Spec:
    """A checked specification from a file, or from one of :func:`examples` by its name.

    Raises
    ------
    SpecError: if the file is missing, no YAML, or has wrong keys.
    """
    content = Fields(load_yaml(_text(path), path))
    content.only("name", "about", "system", *TASKS)
    tasks = [task for task in TASKS if task in content.content]
    if len(tasks) != 1:
        raise SpecError("the specification", f"asks one of {', '.join(TASKS)}, got {', '.join(tasks) or 'none'}")
    name = content.text("name", Path(path).stem)
    if not name or not all(letter.isalnum() or letter in "-_" for letter in name):
        raise SpecError("name", f"is made of letters, digits, - and _, got {name!r}: it names a folder")
    asked = content.content[tasks[0]]
    return Spec(
        name,
        content.text("about", ""),
        content.part("system"),
        tasks[0],
        Fields({} if asked is None else asked, tasks[0]),
    )


def load_yaml(text: str, name: str) -> Any:
    """Plain data; aliases and repeated keys are refused.

    Raises
    ------
    SpecError: with the line that cannot be read.
    """
    try:
        import yaml
    except ImportError as error:
        raise MissingDependencyError(
            "specifications are read with PyYAML, which is not installed: install robust_core[all]"
        ) from error

    class Loader(yaml.SafeLoader):
        """Plain data only."""

        def compose_node(self, parent: Any, index: Any) -> Any:
            if self.check_event(yaml.AliasEvent):
                raise SpecError(name, "aliases are not allowed")
            return super().compose_node(parent, index)

        def construct_mapping(self, node: Any, deep: bool = False) -> Any:
            seen = set()
            for key, _ in node.value:
                if key.value in seen:
                    raise SpecError(name, f"line {key.start_mark.line + 1}: {key.value!r} is there twice")
                seen.add(key.value)
            return super().construct_mapping(node, deep=True)

    try:
        return yaml.load(text, Loader)
    except yaml.YAMLError as error:
        raise SpecError(name, f"is no YAML: {' '.join(str(error).split())}") from error
    except RecursionError as error:
        raise SpecError(name, "is nested too deeply") from error


def _text(path: str) -> str:
    file = Path(path)
    try:
        if not file.exists() and path in examples():
            return str((_folder() / path).read_text(encoding="utf-8"))
        if file.stat().st_size > _LARGEST_FILE:
            raise SpecError(path, f"is larger than {_LARGEST_FILE} bytes, which no specification needs")
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise SpecError(path, f"cannot be read ({error}); examples are {', '.join(examples())}") from error


def _folder() -> Any:
    return resources.files("robust_core") / "specs"
