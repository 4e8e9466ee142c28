"""The text of a message type and of all types in it, as recordings carry it."""

import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

from ament_index_python.packages import get_package_share_directory

_FIELD = re.compile(r"^\s*(?:(?P<package>\w+)/)?(?P<name>[A-Z]\w*)(?:<=\d+)?(?:\[[^\]]*\])?\s+\w+")
_SEPARATOR = "=" * 80


@cache
def message_definition(type_name: str) -> str:
    """The .msg text of ``package/msg/Name``, then that of every type it contains, each below a separator.

    Empty where the package does not say: a recording without it can still be read by whoever has the type.
    """
    try:
        texts = {type_name: _text(type_name)}
        waiting = [type_name]
        while waiting:
            current = waiting.pop(0)
            for inner in _types_in(texts[current], current.partition("/")[0]):
                if inner not in texts:
                    texts[inner] = _text(inner)
                    waiting.append(inner)
    except (OSError, LookupError, ValueError):
        return ""
    (_, own), *others = texts.items()
    parts = [own, *(f"{_SEPARATOR}\nMSG: {name.replace('/msg/', '/')}\n{text}" for name, text in others)]
    return "\n".join(part.rstrip("\n") for part in parts) + "\n"


def _text(type_name: str) -> str:
    package, _, name = type_name.partition("/msg/")
    if not name:
        raise ValueError(f"{type_name} is no message")
    return (Path(get_package_share_directory(package)) / "msg" / f"{name}.msg").read_text(encoding="utf-8")


def _types_in(text: str, package: str) -> Iterator[str]:
    for line in text.splitlines():
        match = _FIELD.match(line.partition("#")[0])
        if match:
            yield f"{match['package'] or package}/msg/{match['name']}"
