"""What a bake refuses, and leaves alone."""

import os
import signal
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf

import stages
from shots import MESH, REST, Shot, baked_mesh, digest, pose
from skinslide import FrameProblem, Lookup, Slider, StageError, StageProblems, UsageError, bake_to_file
from stages import vectors


def bad_outputs(shot: Shot, tmp_path: Path) -> dict[str, Path]:
    (tmp_path / "file").touch()
    (tmp_path / "folder.usda").mkdir()
    os.symlink(shot.path, tmp_path / "link.usda")
    os.link(shot.cache_path, tmp_path / "hard.usdc")
    return {
        "must end in": tmp_path / "out.txt",
        "is a folder": tmp_path / "folder.usda",
        "does not exist": tmp_path / "missing" / "out.usda",
        "the stage reads": shot.path,
        "reads this file": shot.cache_path,
        "stage reads this": tmp_path / "link.usda",
        "stage reads this file": tmp_path / "hard.usdc",
        "not exist": tmp_path / "file" / "out.usda",
    }


def test_outputs_that_cannot_be(shot, tmp_path):
    outputs = bad_outputs(shot.save(), tmp_path)
    before = digest(shot.path.parent)
    for message, path in outputs.items():
        with pytest.raises(UsageError, match=message):
            bake_to_file(shot.path, path)
    assert digest(shot.path.parent) == before


def test_a_read_only_folder(public_folder):
    shot = Shot(public_folder).save()
    folder = public_folder / "locked"
    folder.mkdir(mode=0o555)
    with stages.as_nobody(), pytest.raises(UsageError, match="not writable"):
        bake_to_file(shot.path, folder / "out.usda")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"lookup": Lookup("egl", device=999)}, "there is no EGL device 999"),
        ({"lookup": Lookup("egl", device=-1)}, "no such device: -1"),
        ({"lookup": "magic"}, "'magic' is not one of auto, egl, exact"),
        ({"jobs": 0}, "jobs is 0"),
        ({"jobs": 1.5}, "whole number"),
        ({"max_folded": -1}, "at least 0"),
        ({"max_clamped": "few"}, "whole number"),
        ({"frames": 1001.0}, "a list of numbers"),
        ({"frames": ["a"]}, "a list of numbers"),
        ({"frames": [None]}, "a list of numbers"),
        ({"frames": "one"}, "'one'"),
        ({"frames": ""}, "empty"),
        ({"frames": []}, "must be some"),
        ({"frames": [1001, float("nan")]}, "finite"),
    ],
)
def test_options_that_cannot_be(shot, out, options, message):
    with pytest.raises(UsageError, match=message):
        bake_to_file(shot.save().path, out, **options)
    assert not out.exists()


def test_limit_needs_a_mesh_that_is_subdivided(shot, out):
    shot.over.CreateAttribute("skinSlide:sheet:interpolation", Sdf.ValueTypeNames.Token).Set("limit")
    with pytest.raises(StageProblems, match="limit needs a mesh that is subdivided"):
        bake_to_file(shot.save().path, out)


def test_the_input_is_not_written(shot, out):
    before = digest(shot.save().path.parent)
    bake_to_file(shot.path, out)
    assert digest(shot.path.parent) == before


def assert_untouched(out: Path, old: bytes) -> None:
    assert out.read_bytes() == old
    assert [path.name for path in out.parent.iterdir() if path.is_file()] == [out.name]


@pytest.mark.parametrize("jobs", [1, 3])
def test_a_bad_frame_leaves_the_output_and_names_itself(shot, out, jobs):
    out.write_text("old")
    bad = pose(3)
    bad[40, 1] = np.nan
    shot.mesh.GetPointsAttr().Set(vectors(bad), 3)
    shot.mesh.GetPointsAttr().Set(vectors(REST[:-1]), 4)
    with pytest.raises(FrameProblem, match=f"{MESH}: .*1003.*40"):
        bake_to_file(shot.save().path, out, jobs=jobs)
    assert_untouched(out, b"old")


def test_limits(shot, out, monkeypatch):
    out.write_text("old")
    slide = Slider.slide

    def fold(self, points, controls, **words):
        frame = slide(self, points, controls, **words)
        return frame._replace(patches=tuple(patch._replace(folded_faces=2) for patch in frame.patches))

    with monkeypatch.context() as patched:
        patched.setattr(Slider, "slide", fold)
        with pytest.raises(FrameProblem, match=r"patch sheet: frame 1001: 2 folded faces, where at most 1 are allowed"):
            bake_to_file(shot.save().path, out, max_folded=1)
    assert_untouched(out, b"old")
    bake_to_file(shot.path, out, max_folded=0, max_clamped=0)
    assert out.read_bytes() != b"old"


def test_replacing_keeps_the_mode(shot, out):
    out.touch()
    out.chmod(0o640)
    bake_to_file(shot.save().path, out)
    assert out.stat().st_mode & 0o777 == 0o640


def test_a_new_output_has_the_mode_of_a_new_file(shot, tmp_path):
    (tmp_path / "new").touch()
    bake_to_file(shot.save().path, tmp_path / "out.usdc")
    assert (tmp_path / "out.usdc").stat().st_mode == (tmp_path / "new").stat().st_mode


def test_a_link_to_the_output_stays_a_link(shot, tmp_path):
    (tmp_path / "real.usda").touch()
    os.symlink("real.usda", tmp_path / "link.usda")
    bake_to_file(shot.save().path, tmp_path / "link.usda")
    assert (tmp_path / "link.usda").is_symlink()
    _stage, mesh = baked_mesh(tmp_path / "real.usda")
    assert mesh.GetPointsAttr().GetNumTimeSamples() == 5


def test_where_no_file_can_be_made(shot):
    """The error names the output, and not the name under which it would have been written first."""
    with pytest.raises(StageError) as raised:
        bake_to_file(shot.save().path, "/proc/out.usdc")
    assert str(raised.value) == "output /proc/out.usdc: No such file or directory"


def test_a_full_disk_leaves_the_output(shot, out):
    """A limit on the size of files stands in for the disk."""
    out.write_text("old")
    code = """
        import resource, signal, sys, skinslide
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096))
        try:
            skinslide.bake_to_file(sys.argv[1], sys.argv[2])
        except skinslide.StageError as error:
            print(error, file=sys.stderr)
            sys.exit(1)
    """
    command = [sys.executable, "-c", textwrap.dedent(code), str(shot.save().path), str(out)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1 and str(out) in done.stderr and len(done.stderr.splitlines()) == 1
    assert_untouched(out, b"old")


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_an_interrupted_bake_leaves_the_output(shot, out, number):
    out.write_text("old")
    code = """
        import sys, time, skinslide
        def stop(done, total):
            if done == 2:
                print("now", flush=True)
                time.sleep(60)
        skinslide.bake_to_file(sys.argv[1], sys.argv[2], progress=stop)
    """
    command = [sys.executable, "-c", textwrap.dedent(code), str(shot.save().path), str(out)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout.readline() == "now\n"
        assert len(list(out.parent.glob(".out*"))) == 2  # the text, and the crate file that it is collected in
        process.send_signal(number)
        assert process.wait(30) != 0
    assert_untouched(out, b"old")
