"""SHA-256 digests of what a layer holds, and the files in which they are recorded."""

import hashlib
from pathlib import Path

import numpy as np
from pxr import Sdf

Digests = dict[str, str]  # "/World/mesh.points" -> "24 samples 5e8f..."


def digest(layer: Sdf.Layer) -> Digests:
    """Of each attribute of a layer with a value: its default and every sample, bit for bit, with their times."""
    found: Digests = {}

    def visit(path: Sdf.Path) -> None:
        spec = layer.GetAttributeAtPath(path) if path.IsPropertyPath() else None
        if spec:
            times = layer.ListTimeSamplesForPath(path)
            values = [(time, layer.QueryTimeSample(path, time)) for time in times]
            if spec.HasInfo("default"):
                values.insert(0, ("default", spec.default))
            if values:
                found[str(path)] = f"{len(values)} values {_sha256(spec.typeName, values)}"

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    return found


def _sha256(type_name: Sdf.ValueTypeName, values: list[tuple]) -> str:
    hashed = hashlib.sha256(str(type_name).encode())
    for time, value in values:
        hashed.update(f" {time}:".encode())
        hashed.update(_bytes(value))
    return hashed.hexdigest()


def _bytes(value) -> bytes:
    array = np.asarray(value)
    return str(value).encode() if array.dtype.kind in "OU" else array.tobytes()


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
        """What is otherwise than recorded, attribute by attribute."""
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
