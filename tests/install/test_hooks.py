"""What formats a commit is what the tests format with."""

import re

from repository import ROOT


def test_the_hooks_have_the_formatters_of_the_tests():
    pinned = re.compile(r"(clang-format|ruff)==[0-9.]+")
    hooks = {match[0] for match in pinned.finditer((ROOT / ".pre-commit-config.yaml").read_text())}
    tests = {match[0] for match in pinned.finditer((ROOT / "pyproject.toml").read_text())}
    assert hooks == tests and len(tests) == 2
