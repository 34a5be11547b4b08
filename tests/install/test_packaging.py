"""What an installed skinslide holds."""

import ast
import importlib.metadata
import os
import pkgutil
import re
import subprocess
import sys
import textwrap
import tomllib
from pathlib import Path

import pytest
from pxr import Plug, Usd

import skinslide
import stages
from repository import ROOT

PACKAGE = Path(skinslide.__file__).parent


def test_one_version():
    declared = re.search(r"project\(skinslide VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text())[1]
    assert skinslide.__version__ == importlib.metadata.version("skinslide") == declared


def test_public_names_exist():
    assert [name for name in skinslide.__all__ if not hasattr(skinslide, name)] == []
    assert set(skinslide.__all__) <= set(dir(skinslide))
    with pytest.raises(AttributeError, match="no attribute 'slide'"):
        _ = skinslide.slide


def test_type_checkers_are_told_what_there_is():
    """The imports for them, the names that are public, and where they come from are three lists of the same."""
    tree = ast.parse(Path(skinslide.__file__).read_text())
    (told,) = (node for node in tree.body if isinstance(node, ast.If))
    imported = [node for node in told.body if isinstance(node, ast.ImportFrom)]
    homes = {node.module.removeprefix("skinslide."): tuple(each.name for each in node.names) for node in imported}
    assert homes == skinslide._HOMES
    own = {"cmake_dir", "plugin_dir"}
    assert sorted(own.union(*homes.values())) == skinslide.__all__


def test_whoever_calls_is_type_checked(tmp_path):
    """By what the package says of itself, and not as Any."""
    script = tmp_path / "call.py"
    script.write_text(
        textwrap.dedent("""
        import numpy as np
        import skinslide

        slider = skinslide.Slider([4], [0, 1, 2, 3], np.zeros((4, 3)), [skinslide.PatchSetup("all", np.arange(1))])
        reveal_type(slider.slide(np.zeros((4, 3))).patches[0].stretch_after)
        reveal_type(slider.patches[0].name)
        reveal_type(skinslide.choose_lookup().lookup)
        reveal_type(skinslide.check("shot.usda").meshes[0].patches[0].free)
        reveal_type(skinslide.bake_to_file("shot.usda", "out.usda", frames=[1]).meshes[0].patches[0].info.piece)
        skinslide.preview("shot.usda", "pictures", views="stretch", sizes=(1, 1))
        skinslide.paint_to_file("shot.usda", "out.usda", "/mesh", "all", 2, treshold=1)
        """)
    )
    command = [sys.executable, "-m", "mypy", "--config-file", ROOT / "pyproject.toml", "--cache-dir", tmp_path, script]
    said = subprocess.run(command, capture_output=True, text=True).stdout
    revealed = re.findall(r'Revealed type is "(.*)"', said)
    assert revealed == ["float", "str", "str", "int", "int"], said
    assert re.findall(r'argument "(\w+)"', said) == ["sizes", "treshold"], said


def test_no_module_is_in_the_place_of_a_function():
    modules = {each.name for each in pkgutil.iter_modules(skinslide.__path__)}
    assert not modules & set(skinslide.__all__)


def run_python(code: str) -> str:
    command = [sys.executable, "-c", textwrap.dedent(code)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("words", ["--help", "--version", "bake --help", "slide"])
def test_help_loads_neither_usd_nor_numpy(words):
    said = run_python(f"""
        import sys
        from skinslide.command.start import main
        sys.argv = ["skinslide", *{words.split()}]
        code = main()
        print(code, *{{"pxr", "numpy", "tqdm", "PIL"}} & sys.modules.keys())
    """)
    assert said.splitlines()[-1].strip() in ("0", "2")


def test_a_bake_loads_nothing_that_it_seldom_needs(tmp_path):
    shot = stages.save(stages.patched_stage()[0], tmp_path / "shot.usda")
    said = run_python(f"""
        import sys
        from skinslide.command.start import main
        sys.argv = ["skinslide", "bake", {str(shot)!r}, "-o", {str(tmp_path / "slid.usda")!r}]
        code = main()
        seldom = {{"tqdm", "PIL", "jinja2", "tempfile", "numpy.ma", "skinslide.picture"}}
        print(code, *(seldom | {{"pxr.UsdShade", "pxr.UsdUtils"}}) & sys.modules.keys())
    """)
    assert said.splitlines()[-1].strip() == "0"


def test_a_page_of_shots_needs_no_usd(tmp_path):
    said = run_python(f"""
        import sys
        from skinslide.command.start import main
        sys.modules["pxr"] = None  # whoever imports it gets an ImportError
        sys.argv = ["skinslide", "report", {str(tmp_path)!r}]
        sys.stderr = sys.stdout
        print(main())
    """)
    assert said.splitlines()[-1] == "2" and "json" in said


def test_schemas_are_read_while_a_command_is_loaded(tmp_path):
    """By a thread beside, and before its function is called, since USD is loaded and at work by turns."""
    said = run_python(f"""
        import sys, threading
        from pxr import Usd
        from skinslide.command.start import main
        read, calls = Usd.SchemaRegistry, []

        def reading():
            threading.Event().wait(0.2)
            calls.append(threading.current_thread() is threading.main_thread())
            return read()

        Usd.SchemaRegistry = reading
        import skinslide.shot.check as home
        home.check = lambda *_stage, **_options: sys.exit(len(calls))
        sys.argv = ["skinslide", "check", {str(tmp_path / "shot.usda")!r}]
        print(main(), *calls)
    """)
    assert said.split() == ["1", "False"]


def test_no_module_of_usd_is_loaded_while_schemas_are_read():
    """By any command that opens a stage: each thread might come to wait for what the other one holds."""
    said = run_python("""
        import sys
        from importlib import import_module
        from pxr import Usd, UsdGeom, UsdSkel
        from skinslide.command.cli import _COMMANDS
        known = set(sys.modules)
        for name, (_, home, _) in _COMMANDS.items():
            if name not in ("stitch", "report"):
                import_module(f"skinslide.{home}")
        print(*(name for name in sys.modules.keys() - known if name.startswith("pxr.")))
    """)
    assert said.split() == []


def test_schemas_that_cannot_be_read(tmp_path):
    said = run_python(f"""
        import sys
        from pxr import Tf, Usd
        from skinslide.command.start import main
        Usd.SchemaRegistry = lambda: Tf.RaiseRuntimeError("two of one name")
        sys.argv = ["skinslide", "check", {str(tmp_path / "shot.usda")!r}]
        sys.stderr = sys.stdout
        print(main())
    """)
    assert said.splitlines() == ["error: USD: Python runtime error: two of one name", "1"]


def test_a_slider_needs_no_usd():
    said = run_python("""
        import sys
        sys.modules["pxr"] = None  # whoever imports it gets an ImportError
        import numpy as np
        import skinslide
        points = np.array([[x, y, 0] for y in range(3) for x in range(3)], np.float32)
        faces = [[i, i + 1, i + 4, i + 3] for i in (0, 1, 3, 4)]
        slider = skinslide.Slider([4] * 4, np.ravel(faces), points, [skinslide.PatchSetup("all", np.arange(4))])
        pulled = points + np.where(np.arange(9) == 4, 0.25, 0)[:, None] * [1, 0, 0]
        print(*slider.slide(pulled).points[4])
    """)
    x, y, z = map(float, said.split())
    assert 1 < x < 1.25 and (y, z) == (1, 0)


def test_the_schema_is_registered_on_import():
    plugin = Plug.Registry().GetPluginWithName("skinslide")
    assert Path(plugin.MakeResourcePath("generatedSchema.usda")).is_file()
    assert Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("SkinSlideAPI")


@pytest.mark.parametrize("command", [["skinslide"], ["python", "-m", "skinslide"]])
def test_the_command_is_installed(command):
    program = Path(sys.executable).parent / command[0]
    done = subprocess.run([program, *command[1:], "--version"], capture_output=True, text=True, check=True)
    assert skinslide.__version__ in done.stdout


def test_numpy_starts_no_threads_in_a_command():
    """As its BLAS does, one for each processor, where it is let."""
    said = run_python("""
        import os
        from skinslide.command import cli, start

        def main():
            import numpy
            print(numpy.__name__, len(os.listdir("/proc/self/task")))
            return 0

        cli.main = main
        start.run()
    """)
    assert said.split() == ["numpy", "1"]


def test_garbage_is_collected_once_a_command_is_loaded(tmp_path):
    """Not before: nothing that is loaded is garbage, and none of it is looked at again."""
    said = run_python(f"""
        import gc, sys
        from skinslide.command.start import main
        early = []
        gc.callbacks.append(lambda *_: gc.get_freeze_count() or early.append("early"))
        sys.argv = ["skinslide", "check", {str(tmp_path / "shot.usda")!r}]
        main()
        print(gc.isenabled(), gc.get_freeze_count() > 10000, *early)
    """)
    assert said.split() == ["True", "True"]


def test_an_interruption_while_the_command_is_loaded(tmp_path):
    code = """
        import os, signal
        from skinslide.command.start import run
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        os.kill(os.getpid(), signal.SIGINT)  # comes as soon as it is let through
        run()
    """
    command = [sys.executable, "-c", textwrap.dedent(code), "check", tmp_path / "shot.usda"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (130, "error: interrupted\n")


def test_an_interruption_while_a_patch_is_set_up(tmp_path):
    """That may take minutes, within one call of the library."""
    code = """
        import os, signal, threading
        from skinslide.arrays import slider
        from skinslide.command.start import run

        def create(*_arguments):
            os.kill(os.getpid(), signal.SIGINT)
            threading.Event().wait()

        slider._create = create
        run()
    """
    shot, out = stages.save(stages.patched_stage()[0], tmp_path / "shot.usda"), tmp_path / "out.usda"
    command = [sys.executable, "-c", textwrap.dedent(code), "bake", shot, "-o", out]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stderr) == (130, "error: interrupted; nothing was written\n")
    assert list(tmp_path.iterdir()) == [shot]


def test_the_headers_are_the_manual():
    written, installed = ROOT / "core" / "include" / "skinslide", PACKAGE / "include" / "skinslide"
    headers = {path.name: path.read_text() for path in installed.iterdir()}
    major, minor, patch = skinslide.__version__.split(".")
    numbers = [("MAJOR", major), ("MINOR", minor), ("PATCH", patch), ("TEXT ", f'"{skinslide.__version__}"')]
    defined = [line for line in headers.pop("version.h").splitlines() if line.startswith("#define SKINSLIDE_VERSION_")]
    assert defined[1:] == [f"#define SKINSLIDE_VERSION_{name} {value}" for name, value in numbers]
    assert headers == {path.name: path.read_text() for path in written.glob("*.h")}


def libraries() -> dict[str, Path]:
    """What an installed skinslide has of machine code, by the names that each may give away."""
    (core,), (plugin,) = (list((PACKAGE / "lib").glob(name)) for name in ("libskinslide*", "skinslideFileFormat*"))
    (binding,) = PACKAGE.glob("_core.*")
    return {"skinslide_": core, "skinslideFormat": plugin, "PyInit__core": binding}


def test_libraries_give_their_own_names_away_and_nothing_else():
    for prefix, library in libraries().items():
        listed = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True, check=True)
        names = [line.split()[-1] for line in listed.stdout.splitlines()]
        assert names and [name for name in names if not name.startswith(prefix)] == [], library


def test_the_core_is_found_by_a_name_with_its_minor():
    """The copies of two versions in one process are then two libraries."""
    major, minor, _patch = skinslide.__version__.split(".")
    soname = f"libskinslide.so.{major}.{minor}"
    core, *others = libraries().values()
    assert core.name == soname

    def dynamic(library: Path) -> str:
        return subprocess.run(["readelf", "-d", library], capture_output=True, text=True, check=True).stdout

    assert re.search(rf"SONAME.*\[{re.escape(soname)}\]", dynamic(core))
    assert all(re.search(rf"NEEDED.*\[{re.escape(soname)}\]", dynamic(other)) for other in others)


def test_one_version_of_usd():
    built_for = re.search(r"set\(usd_wheels ([0-9.]+)\)", (ROOT / "plugin/fileformat/UsdWheels.cmake").read_text())[1]
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert f"pxr-pcp-dev=={built_for}" in settings["build-system"]["requires"]
    assert settings["project"]["optional-dependencies"]["live"] == [f"usd-core=={built_for}"]


def test_a_usd_that_is_there_stays():
    """None is asked for, of whatever version: who has none says so."""
    asked = importlib.metadata.requires("skinslide")
    assert [each for each in asked if "usd" in each.lower()] == ['usd-core==26.8; extra == "live"']


def test_without_any_usd(tmp_path):
    said = run_python(f"""
        import sys
        from skinslide.command.start import main

        class Hiding:
            def find_spec(name, *_others):
                if name.partition(".")[0] == "pxr":
                    raise ModuleNotFoundError("No module named 'pxr'", name="pxr")

        sys.meta_path.insert(0, Hiding)
        sys.stderr = sys.stdout
        for words in (["check", "shot.usda"], ["bake", "shot.usda", "-o", "{tmp_path}/out.usda"]):
            sys.argv = ["skinslide", *words]
            print(main())
    """)
    line = "error: there is no USD in this Python: set the show's up, or install skinslide[live], which brings its own"
    assert said.splitlines() == [line, "1"] * 2


def test_a_project_in_c_builds_against_the_package(tmp_path):
    """CMake finds it, and pkg-config does."""
    consumer, environment = (
        ROOT / "tests" / "consumer",
        os.environ | {"PKG_CONFIG_PATH": str(PACKAGE / "lib/pkgconfig")},
    )
    configure = ["cmake", "-S", consumer, "-B", tmp_path, f"-Dskinslide_DIR={skinslide.cmake_dir()}"]
    subprocess.run(configure, capture_output=True, check=True)
    subprocess.run(["cmake", "--build", tmp_path, "--target", "consumer_c"], capture_output=True, check=True)
    for command in ([tmp_path / "consumer_c"], ["sh", consumer / "pkg-config.sh", "cc", consumer / "main.c"]):
        done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
        version, middle = done.stdout.split()
        assert version == skinslide.__version__
        # From 1.5, where it was pulled to, it goes most of the way back to 1.
        assert 1 <= float(middle) < 1.25
