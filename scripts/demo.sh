#!/bin/bash
# demo.sh MODEL D [OPTION...]: offsets MODEL (a mesh file, or the name of a generated model) by D outward and
# inward, at resolution 256 unless the options say otherwise, and writes everything into ./out.
set -euo pipefail

model=$1
distance=${2#[-+]}
shift 2
resolution=(--resolution 256)
for option in "$@"; do
    case $option in --voxel | --voxel=* | --resolution | --resolution=*) resolution=() ;; esac
done

exocarp() { "${CARGO_TARGET_DIR:-target}/release/exocarp" "$@"; }

# A number or a word from one of our JSON files, which have one field on a line; the first one of its name.
field() { sed -n "s/^ *\"$2\": \"\{0,1\}\([^\",]*\)\"\{0,1\},\{0,1\}$/\1/p" "$1" | head -n 1; }

row() { printf '  %-32s %10s %9s %6s  %s\n' "$@"; }

yes_or_no() { [ "$1" = true ] && echo yes || echo no; }

describe() {
    local json=out/.info.json
    exocarp info "$1" --json >"$json"
    local volume
    volume=$(field "$json" volume)
    row "$1" "$(field "$json" triangles)" "$(printf '%.6g' "${volume/null/0}")" "$(yes_or_no "$(field "$json" closed)")" "$2"
    rm -f "$json"
}

mkdir -p out
if [ -e "$model" ]; then
    input=$model
else
    input=out/$model.ply
    exocarp model "$model" -o "$input" --quiet
fi

name=$(basename "${input%.*}")
for way in outward inward; do
    sign=''
    [ $way = outward ] || sign=-
    echo "offset by $sign$distance, $way:"
    exocarp offset "$input" -d "$sign$distance" ${resolution[@]+"${resolution[@]}"} "$@" \
        -o "out/$name-$way.ply" --vdb "out/$name-$way.vdb" --stats "out/$name-$way.json"
done

echo
row mesh triangles volume closed 'what it shows'
describe "$input" 'the model'
describe "out/$name-outward.ply" "grown by $distance: convex edges become round, concave ones stay sharp"
describe "out/$name-inward.ply" "shrunk by $distance: concave edges become round, convex ones stay sharp"
echo
echo "  out/$name-{outward,inward}.vdb   their narrow bands, for any OpenVDB program (grid \"surface\")"
echo "  out/$name-{outward,inward}.json  settings, times and counts"
for way in outward inward; do
    stats=out/$name-$way.json
    printf '  %-8s voxel size %.5g, wall %.2f s, peak memory %.0f MB\n' $way: "$(field "$stats" voxel)" \
        "$(field "$stats" wall)" "$(($(field "$stats" peak_rss) / 1048576))"
done
