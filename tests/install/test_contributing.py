"""What contributors are told holds: the rooms, the links, the formatters."""

import re
import tomllib

import pytest

from repository import ROOT

CONTRIBUTING = (ROOT / ".github/CONTRIBUTING.md").read_text()
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())


def drawn(heading: str, indent: int) -> list[str]:
    """What stands at the beginnings of the lines of the drawing under a heading, as far in as that."""
    section = CONTRIBUTING.split(f"### {heading}")[1].split("\n### ")[0].split("\n## ")[0]
    return re.findall(rf"^ {{{indent}}}(\w+(?: \| \w+)*)", section, re.MULTILINE)


def test_the_rooms_of_the_core_are_drawn_as_they_are_built():
    rooms = re.search(r"set\(rooms ([a-z ]+)\)", (ROOT / "core/CMakeLists.txt").read_text())[1]
    assert drawn("core/", 4) == rooms.split()[::-1]


def test_the_packages_are_drawn_as_they_are_held():
    layers = next(each["layers"] for each in PROJECT["tool"]["importlinter"]["contracts"] if each["type"] == "layers")
    assert drawn("plugin/", 8) == layers


@pytest.mark.parametrize(
    "page", [".github/CONTRIBUTING.md", ".github/CHANGELOG.md", ".github/SECURITY.md", "examples/README.md"]
)
def test_links_lead_somewhere(page):
    links = re.findall(r"\]\(([^)#]+)[^)]*\)", (ROOT / page).read_text())
    missing = [link for link in links if "://" not in link and not (ROOT / page).parent.joinpath(link).exists()]
    assert links and not missing


def test_commits_are_formatted_as_the_tests_want():
    pinned = re.compile(r"(clang-format|ruff)==[0-9.]+")
    hooks = {match[0] for match in pinned.finditer((ROOT / ".pre-commit-config.yaml").read_text())}
    tests = {match[0] for match in pinned.finditer((ROOT / "pyproject.toml").read_text())}
    assert hooks == tests and len(tests) == 2


def test_what_is_cited_is_the_project():
    cited = dict(re.findall(r"^(\w+): (.+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE))
    named = {"title": "name", "abstract": "description", "license": "license"}
    assert {key: cited[key] for key in named} == {key: PROJECT["project"][name] for key, name in named.items()}
    paper = re.search(r"TR-\S+?(?=\.)", (ROOT / "README.md").read_text())[0]
    assert f"number: {paper}" in (ROOT / "CITATION.cff").read_text()
