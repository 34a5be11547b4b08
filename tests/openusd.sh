#!/usr/bin/env bash
# Builds the live format against a whole OpenUSD that is there, 24.08 or later, and reads it in a C++ host that starts no Python:
# eight threads at once must come to the bytes of the bake. Run by hand: tests/run.sh has the USD of wheels.
#     tests/openusd.sh FOLDER_OF_pxrConfig.cmake
set -euo pipefail
pxr=$(cd "${1:?is to be the folder of pxrConfig.cmake}" && pwd)
EXTRA_PACKAGES=()
. "$(dirname "$0")/../examples/setup.sh"
cd "$root"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# What is in a folder, in the folder $work/NAME.
built() {
    local folder=$1 name=$2
    shift 2
    { cmake -S "$folder" -B "$work/$name" -G Ninja -Dpxr_DIR="$pxr" "$@" && cmake --build "$work/$name"; } >"$work/log" 2>&1 ||
        { cat "$work/log"; exit 1; }
}

say "Live format"
built . format -DSKINSLIDE_FILE_FORMAT=ON -DCMAKE_INSTALL_PREFIX="$work/prefix" -DCMAKE_INSTALL_LIBDIR=lib
cmake --install "$work/format" >/dev/null
format=$work/prefix/lib/skinslideFileFormat.so
[ -z "$(ldd "$format" | grep 'not found')" ] || fail "$(ldd "$format" | grep 'not found')"
symbols=$(nm -D --undefined-only "$format" | grep -cE ' _?Py' || true)
echo "$symbols symbols of Python are asked for"
[ "$symbols" = 0 ] || exit 1

say "Host"
built tests/openusd host
PYTHONPATH=tests/support "$python" tests/openusd/shot.py "$work"
PXR_PLUGINPATH_NAME=$work/prefix/usd SKINSLIDE_CACHE_MB=0 timeout 120 "$work/host/host" "$work/live.skinslide" "$work/baked.usda" 8
