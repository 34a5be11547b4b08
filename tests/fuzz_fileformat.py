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
        "-1",
        "99",
        "1e30",
        "nan",
        "-inf",
        "2147483648",
        "[]",
        "[0]",
        "(",
        ")",
        "{",
        "}",
        '"',
        "@",
        "None",
        "over",
        "class",
    ),
    *(
        "payload = @./cache.usda@",
        "@./x.skinslide@",
        '"limit"',
        '"vertex"',
        '"constant"',
        "instanceable = true",
        "\n",
        ";",
    ),
    *(
        "timeSamples",
        "default",
        "double3[]",
        "half3[]",
        "string[]",
        "spline",
        "clips",
        "active = false",
        "uniform",
        "\x00",
        "ÿ",
    ),
]


def mutated(source: random.Random) -> str:
    text = TEXT
    for _ in range(source.randint(1, 4)):
        kind, at = source.randrange(5), source.randrange(len(text))
        length = source.choice([1, 1, 2, 5, 20, 200])
        if kind == 0:
            text = text[:at] + text[at + length :]
        elif kind == 1:
            text = text[:at] + source.choice(PIECES) + text[at + source.randrange(4) :]
        elif kind == 2:
            text = text[:at] + text[at : at + length] * 2 + text[at + length :]
        elif kind == 3:
            lines = text.split("\n")
            lines.insert(source.randrange(len(lines)), lines.pop(source.randrange(len(lines))))
            text = "\n".join(lines)
        else:
            digits = [i for i, letter in enumerate(text) if letter.isdigit()]
            if digits:
                at = source.choice(digits)
                text = text[:at] + source.choice(PIECES[:9]) + text[at + 1 :]
    return text


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
    Plug.Registry().RegisterPlugins(str(arguments.plugin))
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
