"""Programs of other versions: consumer/abi.c, compiled with headers that are older and newer than the library.

And where members of structs and names of enums are, as recorded in abi.txt:

pytest tests/install/test_abi.py --record   takes what is declared now as right, as a new minor version may
"""

from __future__ import annotations

import re
import subprocess
from pathlib import Path
from typing import NamedTuple

import pytest

import skinslide
from repository import ROOT
from skinslide._core import ffi

PACKAGE = Path(skinslide.__file__).parent
PROGRAM = ROOT / "tests" / "consumer" / "abi.c"
SIZED = re.compile(
    r"typedef struct (\w+) \{\n    size_t size;.*?\n(.*?)\n\} \1;\s*#define \w+_DEFAULT[\s\\]*\{(.*?)\}", re.DOTALL
)
# Of these nothing works without the last member, so no version can have lacked it.
WHOLE = {
    "skinslide_sample",
    "skinslide_neighbours",
    "skinslide_channel",
    "skinslide_texture_layout",
    "skinslide_stage_pose",
}
# What the library fills: a member that it does not know is no question to it, and answered with 0.
ANSWERS = {
    "skinslide_patch_info",
    "skinslide_patch_result",
    "skinslide_roughness",
    "skinslide_lookup_info",
    "skinslide_device_info",
    "skinslide_tessellation_info",
    "skinslide_weld_info",
    "skinslide_neighbours",
}
# The caller's own, without a size.
FIXED = {"skinslide_error", "skinslide_limit_place", "skinslide_viewport", "skinslide_camera"}
NOT_CALLED = {"skinslide_stage_file", "skinslide_stage_pose", "skinslide_stage_subset"}


class Struct(NamedTuple):
    """A struct that may grow: its members as declarations, and its default."""

    members: list[str]
    values: list[str]

    def code(self, name: str) -> str:
        return (
            f"typedef struct {name} {{ size_t size; {' '.join(self.members)} }} {name};\n"
            f"#define {name.upper()}_DEFAULT {{ {', '.join(self.values)} }}\n"
        )


def parsed(body: str, values: str) -> Struct:
    members = []
    for declaration in re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL).split(";"):
        first, *more = (each.strip() for each in declaration.strip().split(","))
        kind = first.rpartition(" ")[0]
        members += [f"{each};" for each in [first, *(f"{kind} {name}" for name in more)] if each]
    return Struct(members, [each.strip(" \\\n") for each in values.split(",")])


def size(members: list[str]) -> int:
    end = 8
    for member in members:
        text = re.fullmatch(r"char \w+\[(\d+)\];", member)
        own = int(text[1]) if text else 8 if "*" in member or member.startswith(("double", "int64_t")) else 4
        end = -(-end // min(own, 8)) * min(own, 8) + own if not text else end + own
    return -(-end // 8) * 8


def older(struct: Struct) -> Struct:
    """The struct before its last member was added, which made it larger."""
    count = len(struct.members)
    while size(struct.members[:count]) == size(struct.members):
        count -= 1
    return Struct(struct.members[:count], struct.values[: count + 1])


def newer(name: str, struct: Struct) -> Struct:
    return Struct([*struct.members, "int64_t later;"], [*struct.values, f"LATER_{name}"])


@pytest.fixture(scope="module")
def structs() -> dict[str, Struct]:
    headers = (PACKAGE / "include" / "skinslide").glob("*.h")
    return {name: parsed(*rest) for path in headers for name, *rest in SIZED.findall(path.read_text())}


def headers_with(changed: dict[str, Struct], folder: Path) -> Path:
    """Writes the headers to a folder, with some structs replaced."""
    for path in (PACKAGE / "include" / "skinslide").glob("*.h"):
        text = SIZED.sub(
            lambda found: changed[found[1]].code(found[1]) if found[1] in changed else found[0], path.read_text()
        )
        (folder / "skinslide").mkdir(exist_ok=True)
        (folder / "skinslide" / path.name).write_text(text)
    return folder


def output(include: Path, folder: Path, *definitions: str) -> list[str]:
    (library,) = (PACKAGE / "lib").glob("libskinslide*")
    program = folder / "abi"
    command = [
        "cc",
        "-Wall",
        "-Wextra",
        "-Werror",
        f"-I{include}",
        *definitions,
        PROGRAM,
        library,
        f"-Wl,-rpath,{library.parent}",
    ]
    subprocess.run([*command, "-o", program], check=True)
    return subprocess.run([program], capture_output=True, text=True, check=True).stdout.splitlines()


@pytest.fixture(scope="module")
def expected(tmp_path_factory) -> list[str]:
    return output(PACKAGE / "include", tmp_path_factory.mktemp("abi"))


def test_the_program_calls_everything(expected, structs):
    assert len(expected) == 20 and not [line for line in expected if "BAD" in line or "UNSUPPORTED" in line]
    text = PROGRAM.read_text()
    assert {
        name for name in structs if f" {name.upper()}_DEFAULT" not in text and f"{{{name.upper()}_DEFAULT" not in text
    } == NOT_CALLED


def test_programs_of_an_older_version(expected, structs, tmp_path):
    """Their structs lack the members that were added last."""
    changed = {name: older(structs[name]) for name in structs.keys() - WHOLE}
    found = output(headers_with(changed, tmp_path), tmp_path, *(f"-DWITHOUT_{name}" for name in changed))
    assert found == expected


def newer_output(structs: dict[str, Struct], folder: Path, asks: str = "") -> list[str]:
    include = headers_with({name: newer(name, struct) for name, struct in structs.items()}, folder)
    return output(include, folder, "-DNEWER", *(f"-DLATER_{name}={int(name == asks)}" for name in structs))


def test_programs_of_a_newer_version(expected, structs, tmp_path):
    """They ask for nothing that is new, and learn nothing about it."""
    found = newer_output(structs, tmp_path)
    unknown = [line for line in found if line not in expected]
    assert [line for line in found if line in expected] == expected
    assert len(unknown) == 11 and all(line.endswith(": 0") for line in unknown)


def test_programs_that_ask_for_what_is_newer(structs, tmp_path):
    for name in sorted(structs.keys() - NOT_CALLED):
        found = newer_output(structs, tmp_path, asks=name)
        refusals = [line for line in found if "UNSUPPORTED" in line]
        words = f"UNSUPPORTED: {name}: it has something that version {skinslide.__version__} does not know"
        assert all(words in line for line in refusals) and bool(refusals) == (name not in ANSWERS), name


# ---- Layouts ----


def is_complete(struct: str) -> bool:
    try:
        return ffi.sizeof(struct) > 0
    except ffi.error:  # known by its name alone
        return False


def declared() -> dict[str, str]:
    """Where each member of a struct and each name of an enum is declared."""
    found = {}
    for name in sorted(ffi.list_types()[0]):
        kind = ffi.typeof(name)
        if kind.kind == "struct" and is_complete(name):
            found[name] = f"{ffi.sizeof(name)}"
            found |= {f"{name}.{member}": f"{each.offset} {each.type.cname}" for member, each in kind.fields}
        elif kind.kind == "enum":
            found |= {word: str(number) for word, number in kind.relements.items() if not word.endswith("_COUNT")}
    return found


def test_layouts_are_those_recorded(request):
    """Within a minor version, members and names stay where they are; what is added to a struct makes it larger."""
    path, found = Path(__file__).with_name("abi.txt"), declared()
    version = ".".join(skinslide.__version__.split(".")[:2])
    if request.config.getoption("--record"):
        path.write_text("".join(f"{name} {place}\n" for name, place in {"version": version, **found}.items()))
    recorded = dict(line.split(" ", 1) for line in path.read_text().splitlines())
    assert recorded.pop("version") == version
    stays = {name: place for name, place in recorded.items() if "." in name or name.isupper() or name in FIXED}
    assert {name: place for name, place in stays.items() if found.get(name) != place} == {}
    for name in found.keys() - recorded.keys():
        struct, _, member = name.partition(".")
        if member and struct in recorded:
            assert int(found[name].split()[0]) >= int(recorded[struct]), name
    for name in recorded.keys() - stays.keys():
        member, last = ffi.typeof(name).fields[-1]
        end = last.offset + ffi.sizeof(last.type)  # where what was added must leave no padding
        assert found[name] == recorded[name] or int(found[name]) == end > int(recorded[name]), f"{name}.{member}"
