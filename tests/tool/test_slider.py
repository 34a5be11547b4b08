"""`skinslide.Slider` on numpy arrays: that they cross to the core and back unharmed. The rest is tested in C."""

import gc
import inspect
import os
import re
import signal
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace

import numpy as np
import pytest
from pxr import UsdGeom, Vt

import skinslide
import stages
from library import accelerations, velocities
from skinslide import Controls, Lookup, PatchSetup, Sample, Slider, SliderError
from skinslide.arrays import attributes, native, slider
from skinslide.arrays.apart import APART, apart, together
from skinslide.shot.workers import pool_of
from skinslide.stage.textures import give_files

SIZE = 12  # quads a side
VERTICES, FACES = (SIZE + 1) ** 2, SIZE**2
SHEET = stages.squares(SIZE)


@pytest.fixture(scope="module")
def counts():
    return SHEET.counts


@pytest.fixture(scope="module")
def indices():
    return SHEET.indices


@pytest.fixture(scope="module")
def rest():
    return SHEET.points


def bumped(rest, at=4.0):
    """The sheet with a bump at x = y = at."""
    points = rest.copy()
    points[:, 2] = 4 * np.exp(-0.2 * ((rest[:, :2] - at) ** 2).sum(axis=1))
    return points


@pytest.fixture(scope="module")
def sheet(counts, indices, rest):
    return Slider(counts, indices, rest, [PatchSetup("sheet", np.arange(FACES))])


def test_rest_in_rest_out(sheet, rest):
    frame = sheet.slide(rest)
    assert frame.points.tobytes() == rest.tobytes()
    assert frame.patches[0].slid_vertices == 0


def test_the_border_keeps_its_bits_and_the_inside_slides(sheet, rest):
    points = bumped(rest)
    frame = sheet.slide(points)
    moved = (frame.points != points).any(axis=1).reshape(SIZE + 1, SIZE + 1)
    assert not moved[[0, -1]].any() and not moved[:, [0, -1]].any()
    assert frame.patches[0].slid_vertices == moved.sum() > 0
    assert frame.patches[0].stretch_after < frame.patches[0].stretch_before
    assert frame.points.dtype == np.float32 and frame.embeddings is None


def test_inputs_are_not_written_and_not_kept(sheet, rest):
    points = bumped(rest)
    before = points.copy()
    first = sheet.slide(points)
    points[:] = np.nan
    assert np.isfinite(first.points).all()
    assert sheet.slide(before).points.tobytes() == first.points.tobytes()


def test_patch_arrays(sheet, rest):
    (info,) = sheet.patches
    assert (info.name, info.vertex_count, info.face_count, info.piece_count) == ("sheet", VERTICES, FACES, 1)
    assert sheet.vertices(0).tolist() == list(range(VERTICES))
    assert sheet.faces(0).tolist() == list(range(FACES))
    embedding = sheet.embedding(0)
    assert embedding.shape == (VERTICES, 2) and embedding.min() >= 0 and embedding.max() <= 1
    # At rest the frame's embedding is the rest embedding.
    assert sheet.slide(rest, embeddings=True).embeddings[0].tobytes() == embedding.tobytes()


@pytest.mark.parametrize("patch", [-1, 1])
def test_a_patch_that_is_not_there(sheet, patch):
    with pytest.raises(SliderError, match=f"no patch {patch}"):
        sheet.embedding(patch)


def test_fields_are_those_of_the_header(sheet, rest):
    result = sheet.slide(rest).patches[0]
    assert {"clamped_vertices", "folded_faces", "stretch_before", "locate_seconds"} <= set(result._fields)
    assert {"name", "hole_count", "zero_length_edges"} <= set(sheet.patches[0]._fields)


def test_tokens_are_those_of_the_stage():
    assert native.tokens("boundary") == ("auto", "square", "circle")
    assert native.tokens("holes") == ("pinned", "free", "freeAll")
    assert native.tokens("rule") == ("unit", "fast", "relaxed", "even")
    assert native.tokens("interpolation") == ("auto", "linear", "meanValue", "limit")
    assert native.tokens("lookup") == ("auto", "egl", "exact")


def test_settings_arrive(counts, indices, rest):
    faces, points = np.arange(FACES), bumped(rest)
    corners = np.array([0, SIZE, VERTICES - 1, VERTICES - 1 - SIZE])
    setups = [
        PatchSetup("p", faces),
        PatchSetup("p", faces, corners=corners),
        PatchSetup("p", faces, rule="fast"),
        PatchSetup("p", faces, rule="relaxed"),
        PatchSetup("p", faces, rule="even"),
        PatchSetup("p", faces, rule="even", holes="freeAll"),
        PatchSetup("p", faces, rule="even", controls=Controls(hold=np.full(VERTICES, 5.0))),
        PatchSetup("p", faces, rule="even", controls=Controls(stretch_response=0.5)),
        PatchSetup("p", faces, rule="even", controls=Controls(compression_response=0.5)),
        PatchSetup("p", faces, interpolation="meanValue"),
        PatchSetup("p", faces, controls=Controls(envelope=0.5)),
        PatchSetup("p", faces, controls=Controls(weight=np.full(VERTICES, 0.25))),
        PatchSetup("p", faces, controls=Controls(max_distance=np.full(VERTICES, 0.01))),
        PatchSetup("p", faces, controls=Controls(vertex_density=np.linspace(1, 9, VERTICES))),
        PatchSetup("p", faces, controls=Controls(face_density=np.linspace(1, 9, FACES))),
        PatchSetup("p", faces, controls=Controls(edges=np.array([[40, 41]]), edge_density=np.array([50.0]))),
    ]
    slid = [Slider(counts, indices, rest, [setup]).slide(points).points.tobytes() for setup in setups]
    assert len(set(slid)) == len(slid)


def test_controls_of_a_frame_stand_in_for_the_setups(sheet, counts, indices, rest):
    points, half = bumped(rest), Controls(envelope=0.5)
    alone = Slider(counts, indices, rest, [PatchSetup("sheet", np.arange(FACES), controls=half)])
    assert sheet.slide(points, [half]).points.tobytes() == alone.slide(points).points.tobytes()
    assert sheet.slide(points, [Controls(envelope=0)]).points.tobytes() == points.tobytes()


@pytest.mark.parametrize("convert", [np.float64, np.asfortranarray, np.ndarray.tolist])
def test_arrays_of_other_types_and_orders(sheet, rest, convert):
    points = bumped(rest)
    assert sheet.slide(convert(points)).points.tobytes() == sheet.slide(points).points.tobytes()


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"faces": np.arange(3).reshape(3, 1)}, r"patch elbow: faces: the shape is 3 x 1; it must be n"),
        ({"faces": np.array([0.5])}, r"patch elbow: faces: float64 values do not fit int32"),
        ({"faces": np.array([2**40])}, r"patch elbow: faces: int64 values do not fit int32"),
        ({"faces": np.ones(FACES - 1, bool)}, rf"patch elbow: faces: {FACES - 1} values for {FACES} faces"),
        ({"faces": None}, r"patch elbow: faces: the shape is a single value; it must be n"),
        ({"controls": None}, r"patch elbow: controls is of the type NoneType; Controls is wanted"),
        ({"controls": Controls(envelope="a")}, r"patch elbow: envelope: could not convert string"),
        ({"controls": Controls(envelope=None)}, r"patch elbow: envelope: float\(\) argument must be"),
        ({"corners": np.array([1, 2, 3])}, r"patch elbow: corners: the shape is 3; it must be 4"),
        ({"rule": "stiff"}, r"patch elbow: rule 'stiff' is not one of unit, fast, relaxed"),
        ({"boundary": "SQUARE"}, r"patch elbow: boundary 'SQUARE' is not one of auto, square, circle"),
        ({"controls": Controls(weight=np.ones(3))}, rf"patch elbow: weight: the shape is 3; it must be {VERTICES}"),
        ({"controls": Controls(vertex_density=np.ones(1))}, rf"vertex density: the shape is 1; it must be {VERTICES}"),
        ({"controls": Controls(face_density=1.0)}, rf"face density: the shape is a single value; it must be {FACES}"),
        ({"controls": Controls(weight=np.array(["a"] * VERTICES))}, r"weight: <U1 values do not fit float32"),
        ({"controls": Controls(edges=np.array([[0, 1]]))}, r"edges and edge density must be given together"),
        (
            {"controls": Controls(edges=np.array([[0, 1]]), edge_density=np.ones(2))},
            r"edge density: the shape is 2; it must be 1",
        ),
    ],
)
def test_what_cannot_cross_is_named(counts, indices, rest, changed, message):
    setup = PatchSetup(**{"name": "elbow", "faces": np.arange(FACES), **changed})
    with pytest.raises(SliderError, match=message) as error:
        Slider(counts, indices, rest, [setup])
    assert error.value.status == "BAD_ARGUMENT"


@pytest.mark.parametrize(
    ("patches", "message"),
    [
        (None, "^patches is of the type NoneType; a sequence of PatchSetup is wanted"),
        ("elbow", "^patches is of the type str; a sequence of PatchSetup is wanted"),
        (PatchSetup("elbow", np.arange(3)), "^patches is of the type PatchSetup; a sequence of PatchSetup is wanted"),
        ([PatchSetup("elbow", np.arange(FACES)), "knee"], r"^patches\[1\] is of the type str; PatchSetup is wanted"),
    ],
)
def test_what_is_no_set_up(patches, message, counts, indices, rest):
    with pytest.raises(SliderError, match=message) as error:
        Slider(counts, indices, rest, patches)
    assert error.value.status == "BAD_ARGUMENT"


def test_controls_that_are_none(sheet, rest):
    for bad, message in ((3, "controls is of the type int"), ([3], r"controls\[0\] is of the type int; Controls is")):
        with pytest.raises(SliderError, match=message):
            sheet.slide(rest, bad)


class TestWrongTypes:
    """One sentence names what is wrong, whether it is an array, a word or a number."""

    @pytest.mark.parametrize("setting", ["boundary", "holes", "rule", "interpolation"])
    @pytest.mark.parametrize("word", [["unit"], np.array(["unit"]), {}, 3])
    def test_of_a_word(self, counts, indices, rest, setting, word):
        with pytest.raises(SliderError, match=f"^patch elbow: {setting} .* is not one of "):
            Slider(counts, indices, rest, [PatchSetup("elbow", np.arange(FACES), **{setting: word})])

    @pytest.mark.parametrize("lookup", [["exact"], Lookup(["exact"]), Lookup(device="0"), Lookup(resolution=None)])
    def test_of_a_lookup(self, lookup):
        with pytest.raises(SliderError, match=r"^(lookup|device|resolution)"):
            skinslide.choose_lookup(lookup)

    def test_of_subdivision(self, counts, indices, rest):
        with pytest.raises(SliderError, match=r"^subdivision is of the type str; Subdivision is wanted"):
            Slider(counts, indices, rest, [], subdivision="catmullClark")

    @pytest.mark.parametrize("number", ["x", [1], 10**400])
    def test_of_a_control(self, sheet, rest, number):
        with pytest.raises(SliderError, match=r"^patch sheet: envelope: "):
            sheet.slide(rest, [Controls(envelope=number)])

    @pytest.mark.parametrize("patch", [None, "sheet", 0.0, [0], np.arange(2), 2**40])
    def test_of_an_index(self, sheet, rest, patch):
        for asked in (
            sheet.vertices,
            sheet.faces,
            sheet.embedding,
            lambda patch: sheet.id_buffer(rest, patch),
            lambda patch: sheet.neighbours(patch, rest, rest),
        ):
            with pytest.raises(SliderError, match=r"^(patch: |there is no patch )"):
                asked(patch)

    def test_of_a_tolerance(self, sheet, rest):
        with pytest.raises(SliderError, match=r"^tolerance: "):
            sheet.neighbours(0, rest, rest, "x")

    @pytest.mark.parametrize("chosen", [3, [[True]], ["yes"]])
    def test_of_what_is_chosen(self, sheet, rest, chosen):
        with pytest.raises(SliderError, match=r"^chosen: "):
            sheet.diagnose(rest, rest, chosen=chosen)

    @pytest.mark.parametrize("samples", [None, "abc", [1, 2, 3]])
    def test_of_samples(self, sheet, samples):
        with pytest.raises(SliderError, match=r"^samples.* is of the type .*Sample is wanted"):
            sheet.roughness(samples)


@pytest.mark.parametrize("convert", [np.asarray, np.ndarray.tolist])
def test_faces_by_a_bool_each(convert, counts, indices, rest):
    chosen = np.arange(FACES) % SIZE < SIZE // 2
    by_index = Slider(counts, indices, rest, [PatchSetup("half", np.flatnonzero(chosen))])
    by_bool = Slider(counts, indices, rest, [PatchSetup("half", convert(chosen))])
    assert by_bool.faces(0).tolist() == by_index.faces(0).tolist()
    assert by_bool.slide(bumped(rest)).points.tobytes() == by_index.slide(bumped(rest)).points.tobytes()


def test_what_the_core_says_arrives(counts, indices, rest):
    with pytest.raises(SliderError, match="patch elbow") as error:
        Slider(counts, indices, rest, [PatchSetup("elbow", np.array([FACES]))])
    assert error.value.status == "BAD_PATCH"
    with pytest.raises(SliderError) as error:
        Slider(counts, indices, rest, [PatchSetup("elbow", np.arange(FACES), interpolation="limit")])
    assert error.value.status == "BAD_CONTROL"
    with pytest.raises(SliderError) as error:
        Slider(counts, indices, rest, [], lookup=Lookup("egl", device=999))
    assert error.value.status == "NO_DEVICE"


@pytest.mark.parametrize("points", [np.zeros((VERTICES - 1, 3)), np.zeros(VERTICES * 3), np.zeros((VERTICES, 2))])
def test_points_of_another_shape(sheet, points):
    with pytest.raises(SliderError, match=rf"points: the shape is .*; it must be {VERTICES} x 3"):
        sheet.slide(points)


def test_bad_points_leave_the_slider_usable(sheet, rest):
    bad = rest.copy()
    bad[17, 1] = np.inf
    with pytest.raises(SliderError, match="17") as error:
        sheet.slide(bad)
    assert error.value.status == "BAD_POINTS"
    assert sheet.slide(rest).points.tobytes() == rest.tobytes()


def test_controls_for_another_number_of_patches(sheet, rest):
    with pytest.raises(SliderError, match="2 given for 1 patches"):
        sheet.slide(rest, [Controls(), Controls()])


def test_threads_share_a_slider(sheet, rest):
    poses = [bumped(rest, at) for at in np.linspace(2, 10, 16)]
    alone = [sheet.slide(pose).points.tobytes() for pose in poses]
    barrier = threading.Barrier(4)

    def slide_all(_):
        barrier.wait()
        return [sheet.slide(pose).points.tobytes() for pose in poses]

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(slide_all, range(4))) == [alone] * 4


def slid_until_stopped(sheet, points):
    with pytest.raises(SliderError) as stopped:
        while True:
            sheet.slide(points)
    return stopped.value.status


@pytest.fixture
def own_sheet(counts, indices, rest):
    return Slider(counts, indices, rest, [PatchSetup("sheet", np.arange(FACES))])


def test_a_slider_that_is_stopped_slides_no_more(own_sheet, rest):
    with ThreadPoolExecutor(3) as pool:
        statuses = [pool.submit(slid_until_stopped, own_sheet, bumped(rest)) for _ in range(3)]
        own_sheet.stop()
    assert [status.result() for status in statuses] == ["INTERRUPTED"] * 3
    assert slid_until_stopped(own_sheet, bumped(rest)) == "INTERRUPTED"


def test_a_signal_stops_the_frames_of_a_pool(own_sheet, rest):
    with pytest.raises(KeyboardInterrupt), pool_of(2, 9, [own_sheet]) as pool:
        frames = [pool.submit(slid_until_stopped, own_sheet, bumped(rest)) for _ in range(9)]
        raise KeyboardInterrupt
    assert all(frame.cancelled() or frame.result() == "INTERRUPTED" for frame in frames)


def goes_on():
    """Whether a call is still running for which nobody waits."""
    return any(thread.name.startswith(APART) for thread in threading.enumerate())


def end_all(ended):
    """Ends what a signal left running."""
    ended.set()
    for thread in threading.enumerate():
        if thread is not threading.main_thread() and thread.name.startswith(APART):
            thread.join()
    assert not goes_on()


def test_a_signal_does_not_wait_for_a_picture(own_sheet):
    begun, ended = threading.Event(), threading.Event()
    with pytest.raises(KeyboardInterrupt), pool_of(1, 9, [own_sheet]) as pool:
        pictures = [pool.submit(lambda: begun.set() or ended.wait()) for _ in range(2)]
        begun.wait()
        raise KeyboardInterrupt
    assert goes_on() and not pictures[0].done() and pictures[1].cancelled()
    end_all(ended)
    assert pictures[0].result()


def test_a_signal_is_answered_while_a_call_goes_on():
    ended = threading.Event()

    def call(number):
        os.kill(os.getpid(), number)
        ended.wait()

    with pytest.raises(KeyboardInterrupt):
        apart(call, signal.SIGINT)
    assert goes_on()
    end_all(ended)


def test_a_signal_is_answered_that_wakes_another_thread():
    ended = threading.Event()

    def call(number):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, [number])
        time.sleep(0.2)  # by when the main thread waits
        os.kill(os.getpid(), number)
        ended.wait(5)

    mask = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        with pytest.raises(KeyboardInterrupt):
            apart(call, signal.SIGINT)
        assert goes_on()
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)
        end_all(ended)


class Reading:
    """Controls that want a file, and read it when nobody waits for them any more."""

    def __init__(self, path):
        self.path, self.ended, self.read = path, threading.Event(), b""

    def need(self):
        return SimpleNamespace(path=str(self.path), largest=99)

    def holds(self, path):
        return False

    def give(self, file):
        os.kill(os.getpid(), signal.SIGINT)
        self.ended.wait()
        self.read = os.pread(file.descriptor, file.size, 0)


def test_a_file_stays_open_for_as_long_as_it_is_read(tmp_path):
    (tmp_path / "map.exr").write_bytes(b"texels")
    controls = Reading(tmp_path / "map.exr")
    with pytest.raises(KeyboardInterrupt):
        give_files(controls)
    end_all(controls.ended)
    assert controls.read == b"texels"


def test_what_a_call_apart_gives():
    assert apart(divmod, 7, 2) == (3, 1)
    with pytest.raises(ZeroDivisionError):
        apart(divmod, 7, 0)


def together_and_where(jobs):
    """Squares of numbers, and the threads that found them: each waits for the others."""
    waiting = threading.Barrier(jobs)

    def square(number):
        waiting.wait(60)
        return number * number, threading.get_ident()

    squares, threads = zip(*together(square, 2 * jobs, jobs), strict=True)
    return list(squares), set(threads)


@pytest.mark.parametrize("jobs", [1, 4])
def test_what_calls_together_give(jobs):
    squares, threads = together_and_where(jobs)
    assert squares == [number * number for number in range(2 * jobs)]
    assert len(threads) == jobs and threading.get_ident() in threads
    assert together(str, 0, jobs) == []


@pytest.mark.parametrize("jobs", [1, 4])
def test_the_first_of_what_calls_together_raise(jobs):
    with pytest.raises(ValueError, match="'3'"):
        together(lambda number: number if number < 3 else [].index(str(number)), 8, jobs)


def test_ctrl_c_ends_calls_together():
    called = []

    def interrupted(number):
        called.append(number)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        together(interrupted, 8, 1)
    assert called == [0]


def test_calls_together_where_there_are_no_more_threads(monkeypatch):
    def start(_thread):
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", start)
    assert together(str, 3, 4) == ["0", "1", "2"]


QUARTERS = [
    PatchSetup(rule, np.flatnonzero(np.arange(FACES) // SIZE * 4 // SIZE == number), rule=rule)
    for number, rule in enumerate(native.tokens("rule"))
]


def test_a_slider_is_the_same_by_any_number_of_threads(counts, indices, rest):
    made = [Slider(counts, indices, rest, QUARTERS, jobs=jobs) for jobs in (1, 2, 9)]
    assert made[0].patches == made[1].patches == made[2].patches
    frames = [each.slide(bumped(rest)).points.tobytes() for each in made]
    assert frames[0] == frames[1] == frames[2] != bumped(rest).tobytes()


def test_the_first_patch_that_cannot_be_is_named_by_any_number_of_threads(counts, indices, rest):
    bad = [*QUARTERS, PatchSetup("none", np.array([0, 0])), PatchSetup("no more", np.array([FACES])), *QUARTERS]
    for jobs in (1, 2, 9):
        with pytest.raises(SliderError, match="patch none: face 0 is listed more than once"):
            Slider(counts, indices, rest, bad, jobs=jobs)


def test_workspaces_go_before_their_slider(counts, indices, rest):
    for _ in range(50):
        made = Slider(counts, indices, rest, [PatchSetup("sheet", np.arange(FACES))])
        made.slide(bumped(rest))
        made.cycle = made
        del made
    gc.collect()


def test_a_slider_in_a_circle_is_collected(counts, indices, rest):
    """The collector then finalizes what it finds in an order of its own; the core wants workspaces to go first."""
    for _ in range(20):
        circle = [Slider(counts, indices, rest, [PatchSetup("sheet", np.arange(FACES))])]
        circle.append(circle)
        circle[0].slide(rest)
        circle[0].circle = circle
        del circle
        gc.collect()


def test_points_without_measures(rest, sheet):
    measured, alone = sheet.slide(bumped(rest)), sheet.slide(bumped(rest), measures=False)
    assert len(measured.patches) == 1 and alone.patches == ()
    assert alone.points.tobytes() == measured.points.tobytes()


def test_carry(counts, indices, rest, sheet):
    """Vectors along each vertex's own turn stay; others turn about it, by twice what its sine is of."""
    assert sheet.slide(rest).turns is None
    assert not sheet.slide(rest, turns=True).turns.any()
    turns = sheet.slide(bumped(rest), turns=True).turns
    assert turns.shape == (VERTICES, 3) and turns.dtype == np.float32 and turns.any()
    for interpolation, count in [
        ("vertex", VERTICES),
        ("varying", VERTICES),
        ("faceVarying", 4 * FACES),
        ("uniform", FACES),
    ]:
        cached = np.tile(np.float32([0, 0, 1]), (count, 1))
        same = skinslide.carry(counts, indices, 0 * turns, cached, interpolation)
        assert same.tobytes() == cached.tobytes()
        carried = skinslide.carry(counts, indices, turns, cached, interpolation)
        assert np.allclose(np.linalg.norm(carried, axis=1), 1, atol=1e-6)  # float32
        assert (carried != cached).any() and cached.tobytes() == same.tobytes()
        with pytest.raises(SliderError, match=f"it must be {count} x 3"):
            skinslide.carry(counts, indices, turns, cached[1:], interpolation)
    of_corners = skinslide.carry(counts, indices, turns, np.tile(np.float32([0, 0, 1]), (4 * FACES, 1)), "faceVarying")
    of_vertices = skinslide.carry(counts, indices, turns, np.tile(np.float32([0, 0, 1]), (VERTICES, 1)), "vertex")
    assert of_corners.tobytes() == of_vertices[indices].tobytes()
    along = skinslide.carry(counts, indices, turns, turns, "vertex")
    assert np.allclose(along, turns, atol=1e-7)


def test_the_extent_is_that_of_usd():
    """Bit for bit, also for zeros and for what is not a number."""
    points = np.random.default_rng(1).normal(size=(5000, 3)).astype(np.float32)
    special = np.array([[0.0, -0.0, np.nan], [-0.0, 0.0, np.inf], [np.nan, np.nan, -np.inf]], np.float32)
    for given in (points, special, -special, np.abs(points) * special[0], points[:0], np.vstack([points, special])):
        expected = UsdGeom.PointBased.ComputeExtent(Vt.Vec3fArray.FromNumpy(given))
        assert attributes.extent(given).tobytes() == np.asarray(expected).tobytes()


def test_velocities_and_accelerations():
    # Displacements 0, 1, 4 at 0, 1, 2 seconds, along x: t squared.
    still = np.zeros((1, 3), np.float32)
    samples = [Sample(t, still, still + np.float32([t * t, 0, 0])) for t in (0, 1, 2)]
    cached = np.float32([[5, 6, 7]])
    assert velocities([samples[0], samples[2]], cached).tolist() == [[7, 6, 7]]
    assert accelerations(samples, cached).tolist() == [[7, 6, 7]]
    assert cached.tolist() == [[5, 6, 7]]
    with pytest.raises(SliderError, match="need 2 samples, not 3"):
        velocities(samples, cached)
    with pytest.raises(SliderError):
        velocities([samples[1], samples[0]], cached)


def test_what_it_takes_and_gives_is_public():
    methods = [method for name, method in vars(Slider).items() if callable(method) and name[0] != "_"]
    kinds = [kind for method in [Slider.__init__, *methods] for kind in method.__annotations__.values()]
    named = {getattr(slider, word, None) for word in re.findall(r"\w+", " ".join(kinds))}
    own = {kind.__name__ for kind in named if inspect.isclass(kind) and kind.__module__.startswith("skinslide.")}
    assert {"PatchSetup", "Frame", "Diagnostics"} <= own <= set(skinslide.__all__)


def test_version():
    assert skinslide.__version__.count(".") == 2


def test_no_edges_are_no_edges(counts, indices, rest, sheet):
    none = [Controls(edges=[], edge_density=[])]
    assert sheet.slide(bumped(rest), none).points.tobytes() == sheet.slide(bumped(rest)).points.tobytes()
    with pytest.raises(SliderError, match="edges: "):
        sheet.slide(bumped(rest), [Controls(edges=[], edge_density=[1.0])])


def test_ragged_points(sheet):
    with pytest.raises(SliderError, match="points: "):
        sheet.slide([[0, 0, 0], [1, 1]])


@pytest.mark.parametrize("name", [None, 7, "\udcff", "a\0b"])
def test_what_cannot_name_a_patch(name, counts, indices, rest):
    with pytest.raises(SliderError, match="cannot name a patch"):
        Slider(counts, indices, rest, [PatchSetup(name, np.arange(FACES))])
