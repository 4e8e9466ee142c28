"""Where results are kept: a folder of Parquet files to which rows are only ever added."""

import errno
import itertools
import json
import uuid
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, fields
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from tracked_lab.campaign.run_inputs import FORMAT
from tracked_report.whole_file import write_whole

_MOST_PARTS = 64  # small ones, before they are joined
_LARGE_ROWS = 2000
_SCHEMA = pa.schema(
    [
        ("key", pa.string()),
        ("campaign", pa.string()),
        ("way", pa.string()),
        ("seed", pa.int64()),
        ("cell", pa.string()),
        ("inputs", pa.string()),
        ("status", pa.string()),
        ("error", pa.string()),
        ("values", pa.string()),
        ("wall_s", pa.float64()),
        ("cpu_s", pa.float64()),
        ("commit", pa.string()),
        ("created", pa.string()),
    ]
)


class StoreError(RuntimeError):
    """The store cannot be used; one sentence that names the folder and what to do."""


@dataclass(frozen=True, slots=True)
class StoredRun:
    """One row: what was run, how it ended (ok, failed, timeout), and its figures."""

    key: str
    campaign: str
    way: str
    seed: int
    cell: Mapping[str, str]
    inputs: str
    status: str
    error: str = ""
    values: Mapping[str, float] = field(default_factory=dict)
    wall_s: float = 0.0
    cpu_s: float = 0.0
    commit: str = ""
    created: str = ""

    @property
    def ok(self) -> bool:
        """Whether it has figures."""
        return self.status == "ok"


class RunStore:
    """A store in a folder, which is made if need be.

    A part appears whole or not at all, so that a killed process loses at most what it had not added yet; of rows with
    equal keys the first that is ok counts, else the last.

    Raises
    ------
    StoreError: if the folder cannot be used, or holds a store of another format.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._added = 0
        marker = folder / "format.json"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            if not marker.exists():
                if any(folder.glob("*.parquet")):
                    raise StoreError(f"{folder}: holds Parquet files that no campaign wrote; give another folder")
                write_whole(marker, json.dumps({"format": FORMAT}))
            found = json.loads(marker.read_text()).get("format")
        except OSError as error:
            raise StoreError(f"{folder}: cannot be used as a store ({error.strerror})") from error
        except ValueError as error:
            raise StoreError(f"{marker}: is damaged ({error}); give another folder") from error
        if found != FORMAT:
            raise StoreError(f"{folder}: is of format {found}, this version writes {FORMAT}; give another folder")

    def add(self, runs: Iterable[StoredRun]) -> None:
        """Add rows, all or none.

        Raises
        ------
        StoreError: if they cannot be written; what was there stays.
        """
        rows = [_packed(run) for run in runs]
        if not rows:
            return
        self._write(f"part-{uuid.uuid4().hex}.parquet", rows)
        self._added += 1
        if self._added >= _MOST_PARTS:
            self._added = 0
            self.compact()

    def runs(self) -> dict[str, StoredRun]:
        """Every run, once, by its key."""
        found: dict[str, StoredRun] = {}
        for run in itertools.chain.from_iterable(self._read(part) for part in self._parts()):
            if run.key not in found or not found[run.key].ok:
                found[run.key] = run
        return found

    def compact(self) -> None:
        """The small parts become one; large ones stay, so that the work per row does not grow with the store."""
        small = [part for part in self._parts() if pq.read_metadata(part).num_rows < _LARGE_ROWS]
        rows = [_packed(run) for part in small for run in self._read(part)]
        self._write(f"part-{uuid.uuid4().hex}.parquet", rows)
        for part in small:
            part.unlink(missing_ok=True)

    def _parts(self) -> list[Path]:
        return sorted(self.folder.glob("part-*.parquet"), key=lambda part: (part.stat().st_mtime_ns, part.name))

    def _write(self, name: str, rows: list[dict[str, Any]]) -> None:
        sink = pa.BufferOutputStream()
        pq.write_table(pa.Table.from_pylist(rows, schema=_SCHEMA), sink, compression="zstd")
        try:
            write_whole(self.folder / name, sink.getvalue().to_pybytes())
        except OSError as error:
            reason = "the disk is full" if error.errno == errno.ENOSPC else error.strerror
            raise StoreError(f"{self.folder}: results cannot be written ({reason}); what was there is kept") from error

    def _read(self, part: Path) -> Iterator[StoredRun]:
        try:
            rows = pq.read_table(part).to_pylist()
        except (OSError, pa.ArrowException) as error:
            raise StoreError(f"{part}: cannot be read ({str(error).splitlines()[0]}); remove it") from error
        for row in rows:
            row["cell"], row["values"] = json.loads(row["cell"]), json.loads(row["values"])
            yield StoredRun(**{known.name: row[known.name] for known in fields(StoredRun)})


def _packed(run: StoredRun) -> dict[str, Any]:
    return asdict(run) | {"cell": json.dumps(dict(run.cell)), "values": json.dumps(dict(run.values))}
