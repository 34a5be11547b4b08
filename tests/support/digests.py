"""What a layer holds, bit for bit, and digests of it that are recorded in files."""

import hashlib
import math
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pxr import Sdf


class Values(NamedTuple):
    """The values of an attribute, as bytes, by time or "default"."""

    type_name: str
    at: dict[float | str, bytes]


BLOCKED = b"blocked"  # instead of a value
Contents = dict[str, Values]  # "/World/mesh.points" -> its values
Digests = dict[str, str]  # "/World/mesh.points" -> "24 values 5e8f..."


def contents(layer: Sdf.Layer) -> Contents:
    """Every attribute of a layer that has a value, or is blocked."""
    found: Contents = {}

    def visit(path: Sdf.Path) -> None:
        spec = layer.GetAttributeAtPath(path) if path.IsPropertyPath() else None
        if not spec:
            return
        at = {time: _bytes(layer.QueryTimeSample(path, time)) for time in layer.ListTimeSamplesForPath(path)}
        if spec.HasInfo("default"):
            at["default"] = _bytes(spec.default)
        if at:
            found[str(path)] = Values(str(spec.typeName), at)

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return found


def _bytes(value) -> bytes:
    if isinstance(value, Sdf.ValueBlock):
        return BLOCKED
    array = np.asarray(value)
    return str(value).encode() if array.dtype.kind in "OU" else array.tobytes()


def _in_order(times: Iterable[float | str]) -> list[float | str]:
    """The default before the samples."""
    return sorted(times, key=lambda time: -math.inf if isinstance(time, str) else time)


def differences(a: Contents, b: Contents) -> list[str]:
    """The attributes in which two layers differ, with the first time at which each does."""
    said = []
    for path in sorted(a.keys() | b.keys()):
        if path not in a or path not in b:
            said.append(f"{path} is only in the {'first' if path in a else 'second'}")
        elif a[path].type_name != b[path].type_name:
            said.append(f"{path} is {a[path].type_name} and {b[path].type_name}")
        elif a[path].at != b[path].at:
            times = a[path].at.keys() | b[path].at.keys()
            differ = [time for time in _in_order(times) if a[path].at.get(time) != b[path].at.get(time)]
            said.append(f"{path} differs at {differ[0]}, {len(differ)} times in all")
    return said


def digest(found: Contents) -> Digests:
    """For each attribute, one SHA-256 over all its values."""
    return {path: f"{len(values.at)} values {_sha256(values)}" for path, values in found.items()}


def _sha256(values: Values) -> str:
    hashed = hashlib.sha256(values.type_name.encode())
    for time in _in_order(values.at):
        hashed.update(f" {time}:".encode())
        hashed.update(values.at[time])
    return hashed.hexdigest()


class Record:
    """A file of lines `CASE | ATTRIBUTE | DIGEST`, in order."""

    def __init__(self, path: Path):
        self._path = path
        self._cases: dict[str, Digests] = {}
        for line in path.read_text().splitlines() if path.exists() else []:
            case, attribute, value = line.split(" | ")
            self._cases.setdefault(case, {})[attribute] = value

    def cases(self) -> set[str]:
        return set(self._cases)

    def differences(self, case: str, found: Digests) -> list[str]:
        """What differs from the record, attribute by attribute."""
        recorded = self._cases.get(case, {})
        said = []
        for attribute in sorted(recorded.keys() | found.keys()):
            before, now = recorded.get(attribute, "nothing"), found.get(attribute, "nothing")
            if before != now:
                said.append(f"{case}: {attribute} was {before}, is {now}")
        return said

    def keep(self, cases: set[str]) -> None:
        """Drops what is not one of these."""
        self._cases = {case: digests for case, digests in self._cases.items() if case in cases}

    def take(self, case: str, found: Digests) -> None:
        self._cases[case] = found

    def write(self) -> None:
        lines = [
            f"{case} | {attribute} | {value}\n"
            for case, digests in sorted(self._cases.items())
            for attribute, value in sorted(digests.items())
        ]
        self._path.write_text("".join(lines))
