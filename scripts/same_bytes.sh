#!/usr/bin/env bash
# same_bytes.sh OLD NEW: makes 44 offsets, thickenings and bands of generated models with two
# programs, and compares the bytes of every file they write. For changes that must not change a
# result: a renamed module, a moved function, another build profile.
#
#   OLD, NEW   paths of two `exocarp` programs
#
# Prints a line for each case that differs. Exits with 0 if none does.
set -euo pipefail

old=$(realpath "${1:?usage: same_bytes.sh OLD NEW}")
new=$(realpath "${2:?usage: same_bytes.sh OLD NEW}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

# One case on each line: the output, then the command line without the option for the output.
cases() {
    local model
    for model in anchor bracket carved_cube flower hollow_box near_spheres fin wedge; do
        echo "$model-grown.ply offset $model.ply -d 2% --resolution 128"
        echo "$model-shrunk.ply offset $model.ply -d=-1% --resolution 96"
    done
    for model in sphere cylinder torus linked_tori touching_spheres needle; do
        echo "$model.obj offset $model.ply -d 3% --resolution 64"
    done
    cat <<'LIST'
anchor-0.ply offset anchor.ply -d 0 --resolution 96
anchor-64bit.ply offset anchor.ply -d 2% --resolution 96 --f64
anchor-tolerance.ply offset anchor.ply -d 2% --resolution 64 --tolerance 0.05h
flower-tolerance.ply offset flower.ply -d=-1% --resolution 64 --tolerance 0.02h --f64
fin-resolve.stl offset fin.ply -d=-0.009 --resolution 64 --resolve=2
near_spheres-resolve.ply offset near_spheres.ply -d=-1% --resolution 48 --resolve=1
anchor-stream.ply offset anchor.ply -d 2% --resolution 160 --stream --max-memory 60M
bracket-tile-1.ply offset bracket.ply -d 2% --resolution 96 --tile 1/2
bracket-tile-2.ply offset bracket.ply -d 2% --resolution 96 --tile 2/2
wave-forced.ply offset wave.ply -d 2% --resolution 96 --sign pseudonormal
anchor.vdb offset anchor.ply -d 2% --resolution 96 --only-band
anchor-closest.vdb offset anchor.ply -d 2% --resolution 64 --only-band --closest
anchor-half.vdb offset anchor.ply -d=-1% --resolution 64 --only-band --half --vdb-compression zip
flower.vdb offset flower.ply -d 1% --resolution 64 --only-band --vdb-compression none --unit mm
carved_cube-large.off offset carved_cube.ply -d 25% --resolution 96
wave-inner.ply thicken wave.ply -t 0.1
wave-outer.ply thicken wave.ply -t 0.2 --side outer
wave-fine.ply thicken wave.ply -t 2% --resolution 160
wave-smoothed.ply thicken wave.ply -t 0.1 --section-normals smoothed --rounds 4
wave-64bit.ply thicken wave.ply -t 0.1 --f64
anchor-shell.ply thicken anchor.ply -t 0.03
sphere-shell.ply thicken sphere.ply -t 0.1 --resolution 64
LIST
}

for model in anchor bracket carved_cube cylinder fin flower hollow_box linked_tori near_spheres \
    needle sphere torus touching_spheres wave wedge; do
    "$old" model "$model" -o "$model.ply" --quiet
done

# run PROGRAM FOLDER: makes every case, and leaves a line with its exit code and its bytes' hash.
run() {
    local program=$1 folder=$2 name command option code
    mkdir "$folder"
    while read -r name command; do
        option=(-o "$folder/$name")
        if [[ $command == *--only-band* ]]; then
            option=(--vdb "$folder/$name")
            command=${command/--only-band/}
        fi
        code=0
        # The command's words hold no spaces of their own.
        # shellcheck disable=SC2086
        "$program" $command "${option[@]}" --quiet 2>"$folder/$name.err" || code=$?
        [ "$code" -eq 0 ] || head -1 "$folder/$name.err" >&2
        echo "$name $code $(sha256sum <"$folder/$name" 2>/dev/null | cut -c1-16)"
    done < <(cases)
}

run "$old" old >old.txt
run "$new" new >new.txt
total=$(wc -l <old.txt)
written=$(awk '$2 == 0 && NF == 3' old.txt | wc -l)
if [ "$written" -ne "$total" ]; then
    echo "same_bytes.sh: OLD wrote $written of $total cases only:" >&2
    awk '$2 != 0 || NF != 3' old.txt >&2
    exit 2
fi
if diff old.txt new.txt; then
    echo "$total cases, the same bytes in each"
else
    echo "$(diff old.txt new.txt | grep -c '^>') of $total cases differ" >&2
    exit 1
fi
