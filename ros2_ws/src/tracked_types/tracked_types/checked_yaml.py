"""YAML files checked against a schema, with errors that name the file and the key."""

from pathlib import Path
from typing import Any, Protocol, TypeVar

import yaml
from pydantic import BaseModel, ConfigDict, ValidationError

# Ten times as fast where PyYAML was built with libyaml.
_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


class CheckedModel(BaseModel):
    """Base of every section of a checked file: immutable, and unknown keys are errors."""

    model_config = ConfigDict(frozen=True, extra="forbid")


class ReadableFile(Protocol):
    """What a path and a packaged resource have in common."""

    def read_text(self, encoding: str) -> str:
        """The file's text."""
        ...


class CheckedFileError(ValueError):
    """A file cannot be used; the text names the file, the key and what was expected."""


Model = TypeVar("Model", bound=BaseModel)


def load_checked_yaml(model: type[Model], source: Path | ReadableFile, name: str | None = None) -> Model:
    """Read ``source`` and check it against ``model``; ``name`` is how errors call the file.

    Raises
    ------
    CheckedFileError: if the file is missing, is not YAML, or a key is missing, unknown or out of range.
    """
    called = name or str(source)
    try:
        content = yaml.load(source.read_text(encoding="utf-8"), _Loader)
    except OSError as error:
        raise CheckedFileError(f"{called}: cannot be read ({error.strerror})") from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise CheckedFileError(f"{called}: is not a YAML file ({error})") from error
    return check_content(model, content, called)


def check_content(model: type[Model], content: Any, name: str) -> Model:
    """Check already parsed ``content`` against ``model``; errors are those of `load_checked_yaml`."""
    if not isinstance(content, dict):
        known = ", ".join(model.model_fields)
        raise CheckedFileError(f"{name}: expected keys such as {known}; found {type(content).__name__}")
    try:
        return model.model_validate(content)
    except ValidationError as error:
        raise CheckedFileError(f"{name}: {explain(error)}") from error


def explain(error: ValidationError) -> str:
    """One sentence per offending key: dotted key, what was expected, what was found."""
    sentences = []
    for problem in error.errors():
        key = ".".join(str(part) for part in problem["loc"])
        found = "" if problem["type"] == "missing" else f" (got {problem['input']!r:.80})"
        sentences.append(f"{key}: {problem['msg']}{found}" if key else f"{problem['msg']}{found}")
    return "; ".join(sentences)
