#!/usr/bin/env bash
# Sets up the machine and runs every test: format, lint, the C tests plain and sanitized, the Python tests.
# Arguments go to pytest: ./tests/run.sh -k bake
set -euo pipefail
# The last six are what bpy, Blender as a Python module, is linked to.
EXTRA_PACKAGES=(libcmocka-dev pkg-config chromium chromium-driver fonts-vlgothic slurm-wlm munge
    libgl1 libsm6 libxfixes3 libxi6 libxkbcommon0 libxrender1)
. "$(dirname "$0")/../examples/setup.sh"
cd "$root"

say "Format and lint"
git ls-files -z '*.c' '*.h' '*.cpp' | xargs -0 "$venv/bin/clang-format" --dry-run --Werror
"$venv/bin/ruff" check . && "$venv/bin/ruff" format --check .
PYTHONPATH=plugin/python "$venv/bin/lint-imports" --no-cache --no-logo
"$venv/bin/mypy" --cache-dir build/mypy

# What CMakePresets.json has by that name, in build/NAME.
c_tests() {
    local log=build/$1.log
    { cmake --preset "$1" && cmake --build --preset "$1"; } >"$log" || { cat "$log"; exit 1; }
    ctest --preset "$1" -j "$(nproc)"
}

say "Device of the lookup egl"
"$python" -c 'import skinslide; d = skinslide.choose_lookup("egl"); print(d.device_name, d.renderer, d.driver, sep=", ")'

say "C tests"
c_tests tests
say "C tests under AddressSanitizer and UndefinedBehaviorSanitizer"
c_tests sanitize

# Leaks are not counted: Python and USD never free what they keep. libstdc++ goes first too, or exceptions are not seen.
say "Mutated .skinslide files under AddressSanitizer"
fuzzed=$(mktemp -d)
trap 'rm -rf "$fuzzed"' EXIT
LD_PRELOAD="$(gcc -print-file-name=libasan.so) $(gcc -print-file-name=libstdc++.so)" ASAN_OPTIONS=detect_leaks=0 \
    "$python" tests/format/fuzz_fileformat.py build/sanitize/plugin/fileformat "$fuzzed" --count 3000

say "Python tests"
"$python" -m pytest -q "$@"
