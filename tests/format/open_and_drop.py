"""Threads that open stages with `.skinslide` layers, read a frame of each, and drop them.

    PYTHONPATH=tests/support python tests/format/open_and_drop.py FOLDER THREADS SECONDS [--listen] [--plain]

Says how many stages were opened. A hang holds Python's lock, and so every thread: whoever starts this ends it when it
is late. The first thread, and every other one after it, opens files of its own, which nobody else keeps open, so that
each is read every time, and one that is everybody's. Those between open stages above a layer that stays open, and drop
them without giving way.
"""

import argparse
import random
import threading
import time
from pathlib import Path

from pxr import Sdf, Tf, Usd

from layers import make
from stages import FRAMES, MESH

SUBLAYERS = 4
AT_ONCE = 8


def lay_out(folder: Path, count: int, suffix: str) -> list[Path]:
    """As many files, and for every other one a shot that has it as a payload instead."""
    text = make(folder).read_text()
    for number in range(SUBLAYERS):
        (folder / f"empty{number}.usda").write_text("#usda 1.0\n")
    more = "".join(f"@./empty{number}.usda@, " for number in range(SUBLAYERS))
    shots = []
    for number in range(count):
        file, shot = folder / f"x{number}{suffix}", folder / f"shot{number}.usda"
        file.write_text(text.replace("subLayers = [", f"subLayers = [{more}"))
        shot.write_text(f'#usda 1.0\ndef "World" (payload = @./{file.name}@) {{}}\n')
        shots.append(shot if number % 2 else file)
    return shots


def open_files(paths: list[Path], source: random.Random, end: float) -> int:
    opened = 0
    while time.monotonic() < end:
        stage = Usd.Stage.Open(str(source.choice(paths)))
        assert len(stage.GetAttributeAtPath(f"{MESH}.points").Get(source.choice(FRAMES))) == 49
        opened += 1
    return opened


def open_stages(layer: Sdf.Layer, end: float) -> int:
    opened = 0
    while time.monotonic() < end:
        stages = [Usd.Stage.Open(layer) for _ in range(AT_ONCE)]
        opened += len(stages)
        stages.clear()
    return opened


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("threads", type=int)
    parser.add_argument("seconds", type=float)
    parser.add_argument("--listen", action="store_true", help="hear of every change of a layer, as viewers do")
    parser.add_argument("--plain", action="store_true", help="the same text in .usda files")
    arguments = parser.parse_args()
    shots = lay_out(arguments.folder, arguments.threads + 2, ".usda" if arguments.plain else ".skinslide")
    cache = Sdf.Layer.FindOrOpen(str(arguments.folder / "cache.usda"))
    listener = arguments.listen and Tf.Notice.RegisterGlobally(Sdf.Notice.Base, lambda *notice: time.sleep(0))
    opened, end = [], time.monotonic() + arguments.seconds

    def run(number: int) -> None:
        if number % 2:
            opened.append(open_stages(cache, end))
        else:
            opened.append(open_files([*shots[number : number + 2], shots[-1]], random.Random(number), end))

    threads = [threading.Thread(target=run, args=(number,)) for number in range(arguments.threads)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(opened) == arguments.threads, "a thread ended early"
    del listener
    print(f"{sum(opened)} stages")


if __name__ == "__main__":
    main()
