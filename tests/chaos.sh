#!/usr/bin/env bash
# Attacks skinslide for some minutes: threads that open, read and drop live layers, in a C++ host under ThreadSanitizer and in
# Python, then kills, full disks, limits, calls that fail, and races. Says what did not hold, and how to make that attack again.
#     tests/chaos.sh [--seed N] [--minutes M] [--kind NAME]...    all of it; minutes are those after the threads, by default 5
#     tests/chaos.sh --seed N --only K                            attack K of a seed, and no threads
set -euo pipefail
EXTRA_PACKAGES=(libcmocka-dev pkg-config)
. "$(dirname "$0")/../examples/setup.sh"
cd "$root"
export PYTHONPATH=$root/tests:$root/tests/support

threads() {
    local count log=build/threads.log
    say "Threads of a C++ host, under ThreadSanitizer"
    { cmake --preset threads && cmake --build --preset threads; } >"$log" || { cat "$log"; exit 1; }
    ctest --preset threads
    say "Threads of Python's"
    for count in 2 3 8; do
        timeout 90 "$python" tests/format/open_and_drop.py "$(mktemp -d)" "$count" 30 --listen
    done
}

case " $* " in *" --only "* | *" --help "*) ;; *) threads ;; esac

# Mounts of its own, where they may be had, so that no small disk is left.
apart=(unshare -m)
[ "$(id -u)" = 0 ] || apart=(unshare -rm)
"${apart[@]}" true 2>/dev/null || apart=()
say "Attacks"
exec "${apart[@]}" "$python" -m chaos "$@"
