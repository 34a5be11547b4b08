"""Pictures as files, and the threads that encode them while the next are drawn."""

import io
import threading
import time

import numpy as np
import pytest
from PIL import Image

import skinslide
import stages
from sheets import NAME, draw
from skinslide.command.cli import main
from skinslide.picture import encoding
from skinslide.picture.encoders import Encoders
from skinslide.picture.series import Series

LONG = 30  # seconds, after which what is waited for does not come
FRAMES = stages.FRAMES


# ---- Files ----


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (5, 1), (33, 20), (270, 480)])
def test_a_png_holds_its_pixels(shape):
    pixels = np.random.default_rng(1).integers(0, 256, (*shape, 3), dtype=np.uint8)
    with Image.open(io.BytesIO(encoding.png(pixels))) as image:
        image.verify()  # the sums of its chunks
    with Image.open(io.BytesIO(encoding.png(pixels))) as image:
        assert (image.format, image.mode) == ("PNG", "RGB") and (np.array(image) == pixels).all()


@pytest.mark.parametrize("view", ["chequer", "stretch"])
def test_a_png_is_hardly_larger_than_with_a_filter_for_each_row(view, shot, tmp_path):
    """As Pillow chooses them, at the same level. A sheet whose squares stand straight is worse than any skin."""
    draw(shot, tmp_path, frames="1003", views=view, size=(960, 540))
    path = tmp_path / f"{NAME}.{view}.1003.png"
    with Image.open(path) as image, io.BytesIO() as chosen:
        image.save(chosen, "PNG", compress_level=1)
        assert path.stat().st_size < 1.4 * len(chosen.getvalue())


@pytest.mark.parametrize("dtype", [np.uint8, np.float32])
def test_what_is_displayed_has_no_coverage(dtype):
    """Bytes are in sRGB as they come; of linear light black and white are the ends."""
    white = 255 if dtype == np.uint8 else 1
    pixels = np.zeros((2, 3, 4), dtype)
    pixels[1, :, :3], pixels[..., 3] = white, white / 2
    shown = encoding.displayed(pixels)
    assert shown.dtype == np.uint8 and shown.shape == (2, 3, 3)
    assert (shown[0] == 0).all() and (shown[1] == 255).all()


# ---- Threads ----


@pytest.fixture
def two_views(shot, tmp_path):
    """Draws the shot twice a frame, both at once, one frame after another."""
    return lambda: draw(shot, tmp_path / "out", views=["chequer", "stretch"], jobs=1)


def test_a_picture_is_encoded_while_the_next_is_drawn(two_views, monkeypatch):
    drawn, own, encode = threading.Semaphore(0), Series.draw_all, encoding.png

    def counted(*arguments):
        drawn.release()
        return own(*arguments)

    def after_the_next(pixels):
        nonlocal first
        if first:
            first = not (drawn.acquire(timeout=LONG) and drawn.acquire(timeout=LONG))
            assert not first, "the second frame was not begun before a picture of the first was encoded"
        return encode(pixels)

    first = True
    monkeypatch.setattr(Series, "draw_all", counted)
    monkeypatch.setattr(encoding, "png", after_the_next)
    monkeypatch.setattr(encoding, "thumbnail", lambda _: b"")
    monkeypatch.setattr("skinslide.picture.preview.contact_sheets", lambda _: [])
    assert two_views().pictures == 2 * len(FRAMES)


def test_no_more_pictures_are_held_than_there_is_room_for():
    """Whoever brings one more waits, and goes on once one is encoded."""
    encoders, go, brought = Encoders(1, 2), threading.Event(), []

    def bring():
        for number in range(5):
            brought.append(encoders.encode(lambda number=number: go.wait(LONG) and number))

    with encoders.running():
        thread = threading.Thread(target=bring)
        thread.start()
        deadline = time.monotonic() + LONG
        while len(brought) < 2 and time.monotonic() < deadline:
            time.sleep(0.001)
        thread.join(0.2)
        assert thread.is_alive() and len(brought) == 2
        go.set()
        thread.join(LONG)
        assert [future.result() for future in brought] == list(range(5))


def test_who_waits_for_room_is_let_go_when_the_encoders_end():
    """Of a block that fails: what has begun ends, what has not never does."""
    encoders, go, begun, failed = Encoders(1, 2), threading.Event(), threading.Event(), []

    def bring():
        try:
            while True:
                encoders.encode(lambda: begun.set() or go.wait(LONG))
        except skinslide.StageError as error:
            failed.append(error)

    thread = threading.Thread(target=bring)
    with pytest.raises(KeyboardInterrupt), encoders.running():
        thread.start()
        assert begun.wait(LONG)
        raise KeyboardInterrupt
    thread.join(LONG)
    assert not thread.is_alive() and len(failed) == 1
    go.set()


def test_encoding_that_fails_is_one_line_and_leaves_what_is_there(shot, tmp_path, monkeypatch, capfd):
    """Of the first frame that fails, though the next one fails sooner."""
    later = threading.Event()

    def numbered(_series, _canvas, _views, at, *_):
        yield np.full((1, 1, 4), int(at.title.removeprefix("frame 100")), np.uint8)

    def refuse(pixels):
        if pixels[0, 0, 0] == 1:
            return b"whole"
        if pixels[0, 0, 0] == 2:
            assert later.wait(LONG)
        later.set()
        raise skinslide.SliderError("OUT_OF_MEMORY", f"no room for picture {pixels[0, 0, 0]}")

    monkeypatch.setattr(Series, "draw_all", numbered)
    monkeypatch.setattr(encoding, "png", refuse)
    monkeypatch.setattr(encoding, "thumbnail", lambda _: b"")
    words = ["--size", "64x32", "--view", "chequer", "--jobs", "2", "--quiet"]
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), *words]) == 1
    assert capfd.readouterr().err == f"error: {stages.MESH}: frame {FRAMES[1]:g}: no room for picture 2\n"
    assert [file.read_bytes() for file in (tmp_path / "out").iterdir()] == [b"whole"]


def test_no_memory_to_encode_in(shot, tmp_path, monkeypatch, capfd):
    def refuse(_pixels):
        raise MemoryError

    monkeypatch.setattr(encoding, "png", refuse)
    assert main(["preview", str(shot), "-o", str(tmp_path / "out"), "--size", "64x32", "--quiet"]) == 1
    assert capfd.readouterr().err.count("\n") == 1 and not (tmp_path / "out").exists()
