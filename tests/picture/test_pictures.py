"""`skinslide.arrays.canvas` on numpy arrays: that they cross to the core and back unharmed. The rest is tested in C."""

import gc
import threading

import numpy as np
import pytest

import stages
from skinslide import SliderError, Subdivision
from skinslide.arrays.canvas import (
    Camera,
    Canvas,
    Outline,
    Scale,
    Shape,
    Tessellation,
    Viewport,
    false_colour,
    frame_faces,
)

SIZE = 6  # quads a side
FACES = SIZE**2
SHEET = stages.squares(SIZE)
ALL = np.arange(FACES)
IDENTITY = np.eye(4)


@pytest.fixture(scope="module")
def shape():
    return Shape(SHEET.counts, SHEET.indices)


@pytest.fixture(scope="module")
def sheet():
    return SHEET.points


@pytest.fixture(scope="module")
def tessellation(shape, sheet):
    return Tessellation(shape, sheet, None, ALL)


@pytest.fixture(scope="module")
def camera(shape, sheet):
    return frame_faces(shape, ALL, [sheet], IDENTITY[None], (0, 1, 0), 1.0)


def encoded(light):
    """sRGB, 0 to 255, of linear light."""
    light = np.asarray(light)
    return 255 * np.where(light < 0.0031308, 12.92 * light, 1.055 * light ** (1 / 2.4) - 0.055)


def picture(tessellation, points, camera, side=64, pixels="bytes", **options):
    canvas = Canvas(side, side, pixels)
    canvas.clear((0, 0, 1))
    canvas.draw(tessellation, points, camera, Viewport(0, 0, side, side), **options)
    return canvas.read()


@pytest.mark.parametrize("pixels, dtype", [("bytes", np.uint8), ("floats", np.float32)])
def test_a_clear_canvas(pixels, dtype):
    canvas = Canvas(5, 3, pixels)
    colour = (0.25, 0.5, 1.0)
    canvas.clear(np.array(colour))
    read = canvas.read()
    assert (read.shape, read.dtype) == ((3, 5, 4), dtype)
    expected = [*encoded(colour), 255] if pixels == "bytes" else [*colour, 1]
    assert np.abs(read - np.array(expected)).max() <= (1 if pixels == "bytes" else 1e-3)
    assert canvas.device.renderer and canvas.device.driver


def test_a_sheet_is_drawn_and_its_surroundings_are_not(tessellation, sheet, camera):
    drawn = (picture(tessellation, sheet, camera)[..., :3] != [0, 0, 255]).any(axis=2)
    rows, columns = np.nonzero(drawn)
    reach = 64 / 2 / 1.12
    assert drawn[rows.min() + 1 : rows.max(), columns.min() + 1 : columns.max()].all()
    for side in (rows, columns):
        assert abs(32 - side.min() - reach) < 3 and abs(side.max() + 1 - 32 - reach) < 3


def test_the_top_row_comes_first(tessellation, sheet, camera):
    values = sheet[:, 1]
    read = picture(tessellation, sheet, camera, pixels="floats", scale=Scale(values, 0, SIZE))
    top, bottom = read[8, 32], read[55, 32]
    assert top[0] > 3 * top[2] and bottom[2] > 2 * bottom[0]  # red is high, blue low


def test_a_pose_and_its_way_to_the_world(tessellation, sheet, camera):
    still = picture(tessellation, sheet, camera)
    shift = np.eye(4)
    shift[3, :3] = (2, 0, -1)
    moved = sheet - shift[3, :3].astype(np.float32)
    assert np.array_equal(picture(tessellation, moved, camera, to_world=shift), still)
    assert not np.array_equal(picture(tessellation, moved, camera), still)
    assert np.array_equal(picture(tessellation, sheet.astype(np.float64), camera), still)
    assert np.array_equal(picture(tessellation, np.asfortranarray(sheet), camera), still)


def test_sides(tessellation, sheet, camera):
    front = picture(tessellation, sheet, camera)
    turned = picture(tessellation, sheet, camera, left_handed=True)
    both = picture(tessellation, sheet, camera, left_handed=True, double_sided=True)
    assert list(turned[30, 30]) == [0, 0, 255, 255]
    assert np.array_equal(both[8:56, 8:56], front[8:56, 8:56]) and list(front[30, 30]) != [0, 0, 255, 255]


def test_a_camera_for_a_left_handed_mesh(shape, sheet):
    ours = frame_faces(shape, ALL, [sheet], IDENTITY[None], (0, 1, 0), 1.0)
    theirs = frame_faces(shape, ALL, [sheet], IDENTITY[None], (0, 1, 0), 1.0, left_handed=True)
    assert ours.to_camera.shape == ours.to_screen.shape == (4, 4)
    assert ours.to_camera[2, 2] == pytest.approx(1) and theirs.to_camera[2, 2] == pytest.approx(-1)


def test_subdivided_and_with_st(shape, sheet):
    st = sheet[shape.face_indices, :2] / SIZE
    smooth = Tessellation(shape, sheet, st, ALL[:4], Subdivision())
    assert smooth.flat_faces == 0 and smooth.triangle_count > 2 * FACES
    assert Tessellation(shape, sheet, st, ALL[:4]).triangle_count == 2 * FACES


def test_nothing_is_kept_of_what_is_given(shape, sheet, camera):
    given = [shape.face_counts.copy(), shape.face_indices.copy(), sheet.copy(), ALL.astype(np.int32)]
    made = Tessellation(Shape(*given[:2]), given[2], None, given[3])
    before = picture(made, sheet, camera)
    for array in given:
        array[:] = 0
    gc.collect()
    assert np.array_equal(picture(made, sheet, camera), before)


def test_outlines_go_before_their_tessellation(shape, sheet):
    for _ in range(50):
        made = Outline(Tessellation(shape, sheet, None, ALL), ALL[:4])
        made.cycle = made
        del made
    gc.collect()


def test_threads_share_a_tessellation(tessellation, sheet, camera):
    expected, found = picture(tessellation, sheet, camera), []
    threads = [threading.Thread(target=lambda: found.append(picture(tessellation, sheet, camera))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 3 and all(np.array_equal(one, expected) for one in found)


def test_false_colours_end():
    assert false_colour(-1) == false_colour(0) != false_colour(1) == false_colour(2)


# ---- Bad input ----


def fails(status, message, call, *arguments, **options):
    with pytest.raises(SliderError, match=message) as caught:
        call(*arguments, **options)
    assert caught.value.status == status


@pytest.mark.parametrize("width, height", [(0, 4), (4, -1), (16385, 4), (2**40, 4), (16384, 16384)])
def test_sizes_that_cannot_be(width, height):
    fails("BAD_ARGUMENT", "picture of|canvas options", Canvas, width, height)


def test_canvases_that_cannot_be():
    fails("BAD_ARGUMENT", "pixels 'half' is not one of bytes, floats", Canvas, 4, 4, "half")
    fails("BAD_ARGUMENT", "no such device: -1", Canvas, 4, 4, device=-1)
    fails("NO_DEVICE", "there is no EGL device 31", Canvas, 4, 4, device=31)
    fails("BAD_ARGUMENT", "colour: the shape is 2; it must be 3", Canvas(2, 2).clear, (1, 2))
    fails("BAD_ARGUMENT", "colour", Canvas(2, 2).clear, (1, 2, np.nan))


def test_a_device_by_number(tessellation, sheet, camera):
    assert Canvas(4, 4, device=0).device.device == 0


def test_arrays_that_do_not_fit(shape, sheet, tessellation, camera):
    fails("BAD_ARGUMENT", "st: the shape is 3 x 2", Tessellation, shape, sheet, np.zeros((3, 2)), ALL)
    fails("BAD_ARGUMENT", "faces: .* do not fit int32", Tessellation, shape, sheet, None, ALL + 0.5)
    fails("BAD_ARGUMENT", "face 36 is not one", Tessellation, shape, sheet, None, [FACES])
    fails("BAD_POINTS", "rest points: vertex 0", Tessellation, shape, sheet * np.nan, None, ALL)
    fails("BAD_ARGUMENT", "points: the shape is 3 x 3", picture, tessellation, sheet[:3], camera)
    fails("BAD_POINTS", "points: vertex 0", picture, tessellation, sheet * np.nan, camera)
    fails("BAD_ARGUMENT", "to_world: the shape is 3 x 3", picture, tessellation, sheet, camera, to_world=np.eye(3))
    fails("BAD_ARGUMENT", "values: the shape is 2;", picture, tessellation, sheet, camera, scale=Scale(ALL[:2], 0, 1))
    fails("BAD_ARGUMENT", "to_screen: the shape", picture, tessellation, sheet, Camera(np.eye(4), np.eye(3)))
    fails("BAD_ARGUMENT", "squares", picture, tessellation, sheet, camera, squares=0)


def test_viewports_off_the_canvas(tessellation, sheet, camera):
    canvas = Canvas(8, 8)
    for viewport in ((0, 0, 9, 8), (-1, 0, 4, 4), (0, 0, 0, 4), (0, 2**31 - 1, 4, 4)):
        fails("BAD_ARGUMENT", "viewport is not on", canvas.draw, tessellation, sheet, camera, Viewport(*viewport))
    fails("BAD_ARGUMENT", "viewport:", canvas.draw, tessellation, sheet, camera, Viewport(0, 0, 2**31, 4))


def test_subjects_that_cannot_be_framed(shape, sheet):
    up = (0, 1, 0)
    fails("BAD_ARGUMENT", "no faces, or no poses", frame_faces, shape, ALL, [], np.zeros((0, 4, 4)), up, 1.0)
    fails(
        "BAD_ARGUMENT",
        "points: the shape is 2 x 3",
        frame_faces,
        shape,
        ALL,
        [sheet, sheet[:2]],
        IDENTITY[None],
        up,
        1.0,
    )
    fails("BAD_ARGUMENT", "to_world: the shape", frame_faces, shape, ALL, [sheet, sheet], IDENTITY[None], up, 1.0)
    fails("BAD_ARGUMENT", "up: the shape is 2", frame_faces, shape, ALL, [sheet], IDENTITY[None], (0, 1), 1.0)
    fails("BAD_POINTS", "no camera", frame_faces, shape, ALL, [0 * sheet], IDENTITY[None], up, 1.0)
