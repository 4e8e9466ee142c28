"""Record of one run: channels, events and where they come from; kept as one .npz file."""

import io
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field, ValidationError

from tracked_report.channel import Channel
from tracked_report.channels import CHANNELS
from tracked_report.whole_file import write_whole
from tracked_types import Outline, Pose2
from tracked_types.checked_yaml import CheckedModel, explain

FORMAT = 1


class RunRecordError(ValueError):
    """A record cannot be read; the text names the file and what is wrong with it."""


class CommandLimits(CheckedModel):
    """Limits the commands were subject to (5.2.5), for counting violations."""

    speed_min_mps: float
    speed_max_mps: float
    yaw_rate_max_radps: float


class Event(CheckedModel):
    """Something that happened once: a goal reached, a fault injected, a solver that gave up."""

    stamp_ns: int
    source: str
    text: str


class RunMeta(CheckedModel):
    """What a reader must know of a run besides its channels.

    odom_in_world: x (m), y (m), yaw (rad) of the odom frame's origin in the world frame of the truth.
    wall_duration_s: wall time the run took, None if nobody measured it.
    disturbed_s: begin and end of a sudden change of the robot's pose by force, in simulated time; None without one.
    """

    scenario: str
    variant: str = "run"
    description: str = ""
    variant_description: str = ""
    seed: int | None = None
    created: str = ""
    commit: str = ""
    world: str = ""
    time: str = ""
    suspension: str = ""
    pipeline_latency_s: float | None = None
    wall_duration_s: float | None = None
    odom_in_world: tuple[float, float, float] = (0.0, 0.0, 0.0)
    disturbed_s: tuple[float, float] | None = None
    limits: CommandLimits | None = None
    scene: tuple[Outline, ...] = ()
    machine: dict[str, str | int | float] = Field(default_factory=dict)
    versions: dict[str, str] = Field(default_factory=dict)
    notes: dict[str, str | int | float] = Field(default_factory=dict)

    @property
    def odom_pose(self) -> Pose2:
        """The odom frame's origin in the world."""
        return Pose2(*self.odom_in_world)


@dataclass(frozen=True, slots=True)
class RunRecord:
    """Everything kept of one run. Names of channels are those of `channels.CHANNELS`; others may be added."""

    meta: RunMeta
    channels: Mapping[str, Channel] = field(default_factory=dict)
    events: tuple[Event, ...] = ()

    def channel(self, name: str) -> Channel:
        """Channel ``name``; an empty one if it was not recorded. A name nobody knows raises KeyError."""
        if name in self.channels:
            return self.channels[name]
        if name in CHANNELS:
            return Channel.empty(CHANNELS[name].columns)
        raise KeyError(f"no channel {name!r}; there are {', '.join({**CHANNELS, **self.channels})}")

    def save(self, path: Path) -> Path:
        """Write the record whole, as .npz; `load` gives it back bit for bit."""
        arrays: dict[str, Any] = {}
        for name, channel in self.channels.items():
            arrays[f"{name}/stamps_ns"] = channel.stamps_ns
            arrays[f"{name}/values"] = channel.values
            arrays[f"{name}/arrivals_s"] = channel.arrivals_s
        header = _Header(
            format=FORMAT,
            meta=self.meta,
            events=self.events,
            columns={name: channel.columns for name, channel in self.channels.items()},
        )
        buffer = io.BytesIO()
        np.savez_compressed(buffer, header=np.array(header.model_dump_json()), **arrays)
        return write_whole(path, buffer.getvalue())

    @classmethod
    def load(cls, path: Path) -> "RunRecord":
        """Read a record.

        Raises
        ------
        RunRecordError: if the file is missing, cut short, not a record, of a newer format or inconsistent.
        """
        try:
            # np.load would take any other file for a pickle and advise to trust it.
            with path.open("rb") as stream, np.lib.npyio.NpzFile(stream, allow_pickle=False) as archive:
                header = _Header.model_validate_json(str(archive["header"]))
                if header.format > FORMAT:
                    raise RunRecordError(f"format {header.format} is newer than this program's {FORMAT}")
                channels = {name: _channel(archive, name, columns) for name, columns in header.columns.items()}
        except ValidationError as error:
            raise RunRecordError(f"{path}: {explain(error)}") from error
        except (OSError, zipfile.BadZipFile, zlib.error, EOFError, KeyError) as error:
            raise RunRecordError(f"{path}: is not a readable run record ({error})") from error
        except ValueError as error:
            raise RunRecordError(f"{path}: {error}") from error
        return cls(header.meta, channels, header.events)


class _Header(CheckedModel):
    format: Annotated[int, Field(ge=1)]
    meta: RunMeta
    events: tuple[Event, ...] = ()
    columns: dict[str, tuple[str, ...]]


def _channel(archive: Any, name: str, columns: tuple[str, ...]) -> Channel:
    stamps = archive[f"{name}/stamps_ns"]
    if stamps.dtype.kind not in "iu" or stamps.ndim != 1:
        raise RunRecordError(f"channel {name}: stamps must be whole nanoseconds, got {stamps.dtype} {stamps.shape}")
    values = np.asarray(archive[f"{name}/values"], dtype=np.float64)
    arrivals = np.asarray(archive[f"{name}/arrivals_s"], dtype=np.float64)
    try:
        return Channel(columns, stamps.astype(np.int64), values, arrivals)
    except ValueError as error:
        raise RunRecordError(f"channel {name}: {error}") from error
