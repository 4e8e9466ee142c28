"""The packaged recordings as arrays."""

from collections.abc import Collection
from importlib import resources
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class RecordingError(ValueError):
    """A recording cannot be used; the text names the file and what is wrong with it."""


def load_arrays(name: str, fields: Collection[str], path: Path | None = None) -> dict[str, Array]:
    """Fields of a recording as float64; without ``path``, those of the packaged file ``name``.npz.

    Raises
    ------
    RecordingError: if the file is missing, is no npz, or lacks a field.
    """
    source = path or Path(str(resources.files("tracked_lab") / "data" / "recordings" / f"{name}.npz"))
    try:
        with np.load(source, allow_pickle=False) as content:
            missing = sorted(set(fields) - set(content.files))
            if missing:
                raise RecordingError(f"{source.name}: has no {', '.join(missing)}")
            return {field: np.asarray(content[field], np.float64) for field in fields}
    except OSError as error:
        raise RecordingError(f"{source.name}: cannot be read ({error.strerror or error})") from error
    except RecordingError:
        raise
    except (ValueError, EOFError, AttributeError) as error:
        raise RecordingError(f"{source.name}: is no recording ({error})") from error
