"""Opens mutations of fuzz.skinslide and reads every value: fuzz_fileformat.py PLUGIN_FOLDER WORK_FOLDER

A crash or a hang ends the process; what USD says of a file is not of interest. Takes the plug-in of a folder, so that
one that is built with a sanitizer can be tried; USD's own modules need not be.
"""

import argparse
import ctypes
import faulthandler
import random
from pathlib import Path

import pxr
from pxr import Plug, Sdf, Tf, UsdUtils

TEXT = Path(__file__).with_name("fuzz.skinslide").read_text()
PIECES = [
    *(
        "0",
        "1",
        "-1",
        "99",
        "1e30",
        "nan",
        "-inf",
        "2147483648",
        "[0]",
        "1, 2",
        "[]",
        "(",
        ")",
        "{",
        "}",
        '"',
        "@",
        "None",
    ),
    *("@./x.skinslide@", "instanceable = true", "\n", ";", "active = false", "\x00", "ÿ", "over", "class"),
]
WORDS = [
    *(
        "point3f",
        "float",
        "int",
        "bool",
        "double3",
        "half3",
        "uniform",
        "vertex",
        "constant",
        "faceVarying",
        "one",
        "two",
    ),
    *("points", "velocities", "normals", "envelope", "weight", "patch", "indices", "corners", "edges", "def", "over"),
]


def mutated(source: random.Random) -> str:
    """Mostly what still parses: a number or a line changed; now and then what does not."""
    text = TEXT
    for _ in range(source.randint(1, 3)):
        kind = source.randrange(10)
        if kind < 7:
            text = replaced(text, source.choice([i for i, letter in enumerate(text) if letter.isdigit()]), source)
        elif kind < 8:
            lines = text.split("\n")
            line = lines.pop(source.randrange(len(lines)))
            lines[(at := source.randrange(len(lines))) : at] = [line] * source.randrange(3)
            text = "\n".join(lines)
        elif kind < 9:
            old, new = source.sample(WORDS, 2)
            text = text.replace(old, new, source.choice([1, -1]))
        else:
            text = replaced(text, source.randrange(len(text)), source)
    return text


def replaced(text: str, at: int, source: random.Random) -> str:
    return (
        text[:at]
        + source.choice(PIECES[: source.choice([7, 7, 7, len(PIECES)])])
        + text[at + source.choice([1, 1, 5]) :]
    )


def read_everything(path: Path) -> bool:
    """Whether the file opened."""
    try:
        layer = Sdf.Layer.FindOrOpen(str(path))
        if layer:
            layer.ExportToString()
    except Tf.ErrorException:
        return False
    return layer is not None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("plugin", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    for library in (Path(pxr.__file__).parent.parent / "usd_core.libs").glob("libusd_ms-*"):
        ctypes.CDLL(str(library), ctypes.RTLD_GLOBAL)
    Plug.Registry().RegisterPlugins(str(arguments.plugin.resolve()))
    delegate, source, opened = UsdUtils.CoalescingDiagnosticDelegate(), random.Random(arguments.seed), 0
    (arguments.folder / "cache.usda").write_text('#usda 1.0\nover "World" {}\n')
    for number in range(arguments.count):
        path = arguments.folder / f"{number}.skinslide"
        path.write_text(TEXT if number == 0 else mutated(source))
        faulthandler.dump_traceback_later(60, exit=True)
        opened += read_everything(path)
        assert opened or number, "the file that is mutated must itself open"
        faulthandler.cancel_dump_traceback_later()
        delegate.TakeUncoalescedDiagnostics()
        path.unlink()
    print(f"{arguments.count} files, {opened} of them opened")


if __name__ == "__main__":
    main()
