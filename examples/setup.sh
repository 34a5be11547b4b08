# Sets up a Debian 12 machine, as root or with sudo: system packages, the Python environment in build/venv, the human of
# the examples, and skinslide. Does only what is missing or has changed, so a second run takes seconds. Sourced by
# examples/run.sh and tests/run.sh, which set EXTRA_PACKAGES. Sets root (of the repository), venv and python.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
venv=$root/build/venv
python=$venv/bin/python

say() { printf '\n== %s\n' "$*"; }
fail() { printf 'error: %s\n' "$*" >&2; exit 1; }

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"
    elif command -v sudo >/dev/null; then sudo "$@"
    else fail "these packages are missing, and there is neither root nor sudo to install them: ${missing[*]}"
    fi
}

install_system_packages() {
    local package missing=()
    for package in build-essential cmake ninja-build python3-dev python3-venv libsuitesparse-dev libosd-dev libglm-dev \
        libopenexr-dev libegl-dev libgles-dev libegl1 libgl1-mesa-dri "${EXTRA_PACKAGES[@]}"; do
        dpkg-query -W -f '${Status}' "$package" 2>/dev/null | grep -q 'ok installed' || missing+=("$package")
    done
    [ ${#missing[@]} = 0 ] && return
    command -v apt-get >/dev/null || fail "install these first (named as on Debian 12): ${missing[*]}"
    say "Installing ${missing[*]}"
    as_root apt-get update -qq
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "${missing[@]}" >/dev/null
}

# The packages that build and test skinslide, from pyproject.toml, one a line.
requirements() {
    "$python" - "$root/pyproject.toml" <<'PYTHON'
import sys, tomllib
with open(sys.argv[1], "rb") as file:
    settings = tomllib.load(file)
print(*settings["build-system"]["requires"], *settings["project"]["optional-dependencies"]["test"], sep="\n")
PYTHON
}

install_python_packages() {
    local stamp=$venv/.packages wanted listed packages
    # An environment that was interrupted while it was made has a python, but no pip.
    "$python" -m pip --version >/dev/null 2>&1 || { say "Making $venv"; python3 -m venv --clear "$venv"; }
    wanted=$(sha256sum "$root/pyproject.toml" "$root/examples/setup.sh" | sha256sum)
    [ "$(cat "$stamp" 2>/dev/null)" = "$wanted" ] && return
    say "Installing Python packages"
    listed=$(requirements)
    mapfile -t packages <<<"$listed"
    "$python" -m pip install -q --disable-pip-version-check "${packages[@]}"
    echo "$wanted" >"$stamp"
}

# Hashes what goes into the package, so that an unchanged tree is not built again.
sources_hash() {
    (cd "$root" && find CMakeLists.txt pyproject.toml README.md LICENSE core plugin schema -type f ! -path '*/__pycache__/*' -print0 |
        sort -z | xargs -0 sha256sum | sha256sum)
}

install_skinslide() {
    local stamp=$venv/.skinslide wanted
    wanted=$(sources_hash)
    [ -x "$venv/bin/skinslide" ] && [ "$(cat "$stamp" 2>/dev/null)" = "$wanted" ] && return
    say "Building and installing skinslide"
    "$python" -m pip install -q --disable-pip-version-check --no-build-isolation \
        --config-settings build-dir="$root/build/wheel" "$root[live]"
    echo "$wanted" >"$stamp"
}

install_system_packages
install_python_packages
"$python" "$root/examples/makers/fetch.py"
install_skinslide
