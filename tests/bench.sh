#!/usr/bin/env bash
# Measures what a frame costs, beside what a user would otherwise take: tables of ratios, of one run.
#     tests/bench.sh [--against REVISION] [--sizes N...] [--kinds KIND...] [--rounds N]
#     tests/bench.sh --scale [--rule RULE] [--jobs N] [--large]
# --against pairs this tree with another revision of its repository, and must come first. --scale measures bakes instead, as points,
# patches and frames grow.
set -euo pipefail
EXTRA_PACKAGES=(libeigen3-dev)
. "$(dirname "$0")/../examples/setup.sh"
cd "$root"
if [ "${1:-}" = --scale ]; then
    exec "$python" tests/bench/scale.py "${@:2}"
fi
peers=$root/build/peers
packages=(numpy==2.4.6 scipy==1.17.1 matplotlib==3.11.2 libigl==2.6.3 scikit-sparse==0.4.16 embreex==4.4.0.post1)

install_peers() {
    [ "$(cat "$peers/.packages" 2>/dev/null)" = "${packages[*]}" ] && return
    say "Installing what it is compared with"
    python3 -m venv --clear "$peers"
    "$peers/bin/python" -m pip install -q --disable-pip-version-check "${packages[@]}"
    echo "${packages[*]}" >"$peers/.packages"
}

# The package of another revision, in a folder of its own.
install_revision() {
    local revision site=$root/build/against
    revision=$(git rev-parse --verify "$1^{commit}") || fail "there is no revision $1"
    [ "$(cat "$site/.revision" 2>/dev/null)" = "$revision" ] && return
    say "Building and installing $1"
    rm -rf "$site" && mkdir -p "$site/tree"
    git archive "$revision" | tar -x -C "$site/tree"
    "$python" -m pip install -q --disable-pip-version-check --no-build-isolation --no-deps --target "$site/site" \
        --config-settings build-dir="$site/build" "$site/tree"
    echo "$revision" >"$site/.revision"
}

install_peers
g++ -std=c++17 -O3 -march=native -DNDEBUG -shared -fPIC -Wall -Wextra -Werror -isystem /usr/include/eigen3 \
    tests/bench/compare/eigen.cpp -o build/eigen.so
against=()
if [ "${1:-}" = --against ]; then
    [ $# -ge 2 ] || fail "--against needs a revision"
    install_revision "$2"
    against=(--against "$root/build/against/site" --revision "$2")
    shift 2
fi
PYTHONPATH=tests/bench exec "$peers/bin/python" -m compare --python "$python" --eigen "$root/build/eigen.so" "${against[@]}" "$@"
