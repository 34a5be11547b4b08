#!/usr/bin/env bash
# Makes the wheel that goes to others, build/wheels/*manylinux*.whl: the libraries that it needs are inside, with their licences.
# Then installs it, with the USD of its file format, into a root that has nothing but a Python, and into a new environment; and tries
# it there: a bake, a live layer, chunks, pictures, a project in C.
set -euo pipefail
EXTRA_PACKAGES=(pkg-config)
. "$(dirname "$0")/../examples/setup.sh"
cd "$root"
wheels=$root/build/wheels
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

say "Wheel"
rm -rf "$wheels" && mkdir -p "$wheels"
"$python" -m pip wheel -q --disable-pip-version-check --no-deps --no-build-isolation \
    --config-settings build-dir="$root/build/wheel" -w "$work/raw" "$root"
PATH=$venv/bin:$PATH auditwheel repair -w "$work/repaired" "$work"/raw/*.whl 2>"$work/log" || { cat "$work/log"; exit 1; }
"$python" -m wheel unpack -d "$work/open" "$work"/repaired/*.whl >/dev/null
"$python" tests/wheel/licences.py "$work"/open/*
"$python" -m wheel pack -d "$wheels" "$work"/open/* >/dev/null
wheel=$(echo "$wheels"/*.whl)

say "In a root with nothing but Python"
"$python" tests/wheel/clean_root.py "$work/root"
"$python" -m pip install -q --disable-pip-version-check --target "$work/root/packages" "$wheel[live]"
cp tests/wheel/inside.py tests/support/stages.py "$work/root"
sed -i '/^import pytest$/d' "$work/root/stages.py"
apart=(chroot)
[ "$(id -u)" = 0 ] || apart=(unshare -r chroot)
"${apart[@]}" "$work/root" /usr/bin/env -i PYTHONPATH=/packages PYTHONHOME=/python PYTHONDONTWRITEBYTECODE=1 /python/bin/python /inside.py

say "In a new environment"
python3 -m venv "$work/venv"
"$work/venv/bin/pip" install -q --disable-pip-version-check "$wheel[live]"
(cd "$work/root" && "$work/venv/bin/python" inside.py --pictures)
consumer=$("$work/venv/bin/python" -c 'import skinslide; print(skinslide.cmake_dir())')
cmake -S tests/consumer -B "$work/consumer" -Dskinslide_DIR="$consumer" >"$work/log" && cmake --build "$work/consumer" >>"$work/log" ||
    { cat "$work/log"; exit 1; }
"$work/consumer/consumer_c" && "$work/consumer/consumer_cpp"

say "$wheel"
