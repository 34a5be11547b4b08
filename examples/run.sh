#!/usr/bin/env bash
# Sets up the machine, makes the example stages, bakes them, and prints where the results are and what they show.
set -euo pipefail
EXTRA_PACKAGES=()
. "$(dirname "$0")/setup.sh"

out=$root/build/examples
say "Making and baking the examples"
for example in elbow fine_elbow bicep face finger sleeve chequer bump; do
    "$python" "$root/examples/$example/make.py" "$out/$example" >/dev/null
    "$venv/bin/skinslide" check "$out/$example/stage.usda" >"$out/$example/check.txt"
    "$venv/bin/skinslide" bake "$out/$example/stage.usda" -o "$out/$example/slid.usdc" --json --quiet >"$out/$example/bake.json"
done

"$python" "$root/examples/shot/make.py" "$out/shot" >/dev/null
"$python" "$root/examples/shot/play.py" "$out/shot/shot.usda" >"$out/shot/play.txt"

say "What they show"
"$python" "$root/examples/measure/table.py" "$out"
printf '\n%s: %s\n' "$out/shot/shot.usda, played live" "$(tail -n 2 "$out/shot/play.txt" | head -n 1)"

say "Pictures"
"$venv/bin/skinslide" preview "$out/elbow/stage.usda" -o "$out/elbow/pictures" --html "$out/elbow/report.html" --quiet
"$venv/bin/skinslide" preview "$out/elbow/stage.usda" -o "$out/elbow/pictures" --view chequer 2>/dev/null | tail -n 2
"$python" "$root/examples/measure/pictures.py" "$out/elbow.jpg" "$out/elbow/stage.usda" unit chequer
for example in sleeve face; do
    "$python" "$root/examples/measure/pictures.py" "$out/$example.jpg" "$out/$example/stage.usda" unit,relaxed chequer,stretch
done

say "Lookup by colour-ID rendering"
"$python" "$root/examples/measure/lookup.py" "$out"

say "How far the limit surface of the result is from that of the cache, as a share of the patch's size"
"$python" "$root/examples/measure/limit_distance.py" "$out"/*/stage.usda

say "How smoothly each rule moves skin"
"$python" "$root/examples/measure/smoothness.py" "$out"/{elbow,fine_elbow,bicep,sleeve,finger,chequer,face}/stage.usda | tee "$out/smoothness.txt"

say "Share of the removable stretch that each rule removes"
"$python" "$root/examples/measure/share.py" "$out"/{elbow,bicep,sleeve,finger,chequer,face}/stage.usda | tee "$out/share.txt"

printf '\nLook at %s,\nand at %s\n' "$out/elbow/report.html" "$out/sleeve.jpg, $out/face.jpg and $out/elbow/pictures"
