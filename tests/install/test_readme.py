"""Every command and snippet of the README runs as it stands there, on what examples/run.sh has made."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from repository import EXAMPLES, ROOT

README = (ROOT / "README.md").read_text()
# What is a command, but not run here: the file that runs it, and by what words.
ELSEWHERE = {
    "./examples/run.sh": ("examples/run.sh", ""),
    "./tests/run.sh": ("tests/run.sh", ""),
    "pip install skinslide[live]": ("tests/wheel.sh", "[live]"),
    "python plugin/blender/build.py": ("tests/blender/conftest.py", "build.py"),
    "cmake -S . -B build/c": ("tests/CMakeLists.txt", '--install "${CMAKE_BINARY_DIR}" --prefix'),
    "openjd run": ("tests/farm/test_openjd.py", "openjd"),
}


@pytest.fixture(scope="module")
def root(tmp_path_factory):
    """A repository in which examples/run.sh has run, as far as the README needs it."""
    root = tmp_path_factory.mktemp("readme")
    made = root / "build" / "examples"
    made.mkdir(parents=True)
    (root / "build" / "venv").symlink_to(sys.prefix)
    (root / "examples").symlink_to(EXAMPLES)
    for example in ("body", "character"):
        run([sys.executable, EXAMPLES / example / "make.py", made / example], root)
    (made / "body" / "bake.json").write_text('{"problems": []}')  # of a bake that failed, which is quick
    return root


@pytest.fixture(scope="module")
def body(root):
    return root / "build" / "examples" / "body"


def run(words, folder: Path) -> str:
    """Runs a command that must not fail, in an environment in which skinslide is not on the path."""
    path = ":".join(each for each in os.environ["PATH"].split(":") if not each.startswith(sys.prefix))
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, env={**os.environ, "PATH": path})
    assert done.returncode == 0, f"{words}: {done.stdout}{done.stderr}"
    return done.stdout


def python_snippets() -> list[str]:
    return re.findall(r"```python\n(.*?)```", README, re.DOTALL)


def shell_commands(page: str = README) -> list[str]:
    """The lines of indented blocks, and inline code that begins with a command and goes on, in their order."""
    found = re.findall(r"^    (.+)$|`((?:skinslide|python|pip|cmake|openjd|cd|\./\S+) [^`\n]+)`", page, re.MULTILINE)
    return [re.sub(r"\s+#.*", "", block or inline) for block, inline in found]


def test_readme_is_short():
    assert len(README.splitlines()) < 150


def test_links_lead_somewhere():
    links = [link for link in re.findall(r"\]\(([^)#]+)\)", README) if "://" not in link]
    assert links and all((ROOT / link).exists() for link in links)


@pytest.mark.parametrize("snippet", python_snippets())
def test_python_snippet(snippet, body):
    run([sys.executable, "-c", snippet], body)


def test_shell_commands_in_order(root):
    """All that are not run elsewhere, by one shell; each that writes a file leaves one that is there."""
    commands = [each for each in shell_commands() if not each.startswith(tuple(ELSEWHERE))]
    assert len(commands) > 15 and all(each.startswith(("cd ", "skinslide ")) for each in commands)
    run(["bash", "-euxc", "\n".join(commands)], root)
    folder = root / re.match(r"cd (\S+)", commands[0])[1]
    written = [each for command in commands for each in re.findall(r"(?:-o|--html|--payload) (\S+)", command)]
    assert len(written) > 10 and all((folder / each).exists() for each in written)


def test_the_commands_of_the_examples(root):
    """One is made in full; another, of which only what is particular to it is said, is made before that."""
    text = (EXAMPLES / "README.md").read_text()
    commands = [each for each in shell_commands(text) if "/" in each and not each.startswith("./")]
    assert len(commands) == 5 and "out/character" in commands[-1]
    commands.insert(4, commands[1].replace("body", "character"))
    run(["bash", "-euxc", "\n".join(commands)], root)
    assert (root / "out/body/slid.usdc").exists() and (root / "out/character/stage.usda").exists()


@pytest.mark.parametrize("command", ELSEWHERE)
def test_what_is_run_elsewhere(command):
    file, words = ELSEWHERE[command]
    assert any(each.startswith(command) for each in shell_commands())
    assert words in (ROOT / file).read_text()
