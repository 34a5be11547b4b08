#!/usr/bin/env bash
# Sets up the machine; makes, bakes, draws and measures the examples; and prints the results and where to find them.
set -euo pipefail
EXTRA_PACKAGES=()
. "$(dirname "$0")/setup.sh"
cd "$root"

out=build/examples
examples=(elbow fine_elbow bicep face finger sleeve chequer bump)
unpainted=(body fingers trunk torus)
stage() { echo "$out/$1/stage.usda"; }
step() { printf ' %s' "$1"; }
bake() {
    "$venv/bin/skinslide" check "$(stage "$1")" >"$out/$1/check.txt"
    "$venv/bin/skinslide" bake "$(stage "$1")" -o "$out/$1/slid.usdc" --json --quiet >"$out/$1/bake.json"
}
measure() {
    step "$1"
    "$python" "examples/measure/$1.py" "${@:2}" >"$out/$1.txt"
}

say "Making and baking the examples"
for example in "${examples[@]}"; do
    step "$example"
    "$python" "examples/$example/make.py" "$out/$example" >/dev/null
    bake "$example"
done
for example in "${unpainted[@]}"; do
    step "$example"
    "$python" "examples/$example/make.py" "$out/$example" >/dev/null
    "$venv/bin/skinslide" setup "$out/$example/shot.usda" -o "$(stage "$example")" --whole --force >"$out/$example/setup.txt"
    bake "$example"
done
step "character"
"$python" examples/character/make.py "$out/character" >/dev/null
"$venv/bin/skinslide" setup "$out/character/shot.usda" -o "$(stage character)" --prim /World/char/geo/body_GEO --patch elbow_L \
    --joint lowerarm01_L --force >"$out/character/setup.txt"
bake character
"$venv/bin/skinslide" cache "$(stage character)" -o "$out/character/skinned.usdc" --quiet
"$python" examples/character/play.py "$out/character" >"$out/character/play.txt"
step "shot"
"$python" examples/shot/make.py "$out/shot" >/dev/null
"$python" examples/shot/play.py "$out/shot/shot.usda" >"$out/shot/play.txt"
echo

say "Drawing pictures"
step "body"
"$venv/bin/skinslide" preview "$(stage body)" -o "$out/body/pictures" --html "$out/body/report.html" >"$out/body/preview.txt" 2>&1
"$venv/bin/skinslide" report "$out" >"$out/shots.txt"
"$python" examples/measure/gain.py "$out/gain.jpg" "$(stage body)" "$(stage elbow),$(stage face)" >/dev/null
"$python" examples/measure/wrinkles.py "$out/wrinkles.jpg" "$(stage fingers)" >/dev/null
for example in sleeve face; do
    step "$example"
    "$python" examples/measure/pictures.py "$out/$example.jpg" "$(stage "$example")" unit,relaxed chequer,stretch >/dev/null
done
step "character"
"$python" examples/measure/pictures.py "$out/character.jpg" "$(stage character)" even chequer,stretch /World/seam_CAM >/dev/null
echo

say "Measuring"
measure lookup "$out"
painted=("${examples[@]/#/$out/}")
measure limit_distance "${painted[@]/%//stage.usda}"
measure smoothness "$out"/{elbow,fine_elbow,bicep,sleeve,finger,chequer,face,body,fingers,trunk,torus}/stage.usda
measure normals "$out"/{character,elbow,sleeve,chequer}/stage.usda
"$venv/bin/skinslide" setup "$out/body/shot.usda" -o "$out/body/linear.usda" --whole --interpolation linear --force >/dev/null
measure surface "$out"/{character,chequer}/stage.usda "$out/body/linear.usda" # the others slide on their limit surface
measure stability "$out/stability.svg"
measure rules "$out"/{body,fingers,trunk,torus,elbow,fine_elbow,bicep,face,finger,sleeve,bump}/stage.usda
echo

say "Stretch of each patch over 24 frames, at its worst frame, in the cache and once its skin has slid"
"$python" examples/measure/table.py "$out"

say "The character: the jump of its normals at a tiny slide (should be 0), and their angles across its seams, in degrees"
head -n 2 "$out/normals.txt"
say "Points off the surface (should be 0)"
cat "$out/surface.txt"
cat <<SUMMARY

Look at these in $out:
  body/report.html               a body with nothing painted, in a browser, from the frame at which most stretch is removed
  shots.html                     all of them on one page, those with most stretch left first
  gain.jpg                       an elbow and a face of it: the cache, a painted patch, and nothing painted
  sleeve.jpg face.jpg character.jpg  the cache and the slid skin, by each rule
  wrinkles.jpg                   a hand that closes, wrinkled where its skin is pressed together
  id_buffers.png                 the textures in which the lookup finds faces
For each example, such as the elbow:
  elbow/stage.usda               the cache and its patch; sublayer elbow/slid.usdc above it
  elbow/check.txt bake.json      what check found on the stage, and what happened at each frame
  body/shot.usda setup.txt       a shot with nothing painted, and how setup --whole made body/stage.usda from it
  character/shot.usda play.txt   a character as its rig has it, set up by a joint; its bake and a live layer compared
  shot/play.txt                  shot/shot.usda, played live with nothing baked
Measurements:
  stability.txt stability.svg    how a triangle turned along a sphere moves in the embedding, with each kind of weight
  rules.txt                      each rule on the examples: share of the removable stretch, roughness, folds, time
  times.txt lookup.txt           milliseconds of each stage of a slide, for each patch; how many vertices the texture finds
  limit_distance.txt surface.txt how far the limit surface moves; how far slid points are from the surface of the cache
  smoothness.txt normals.txt     how smoothly each rule moves skin; how authored normals are carried with it
SUMMARY
