#!/usr/bin/env bash
# instructions.sh OLD NEW: compares two commits by the instructions that a small offset takes, under valgrind's
# callgrind. Unlike times they do not depend on the machine's mood: a change of one percent is seen.
set -euo pipefail
cd "$(dirname "$0")/.."

old=${1:?usage: instructions.sh OLD NEW}
new=${2:?usage: instructions.sh OLD NEW}
command -v valgrind >/dev/null || { echo "instructions.sh: valgrind is missing; install it (apt-get install valgrind)" >&2; exit 1; }

work=$(mktemp -d)
clean() {
    for side in old new; do git worktree remove --force "$work/$side" 2>/dev/null || true; done
    rm -rf "$work"
}
trap clean EXIT

# name commit: prints "name, instructions" of each case, and leaves the profiles in $work.
measure() {
    git worktree add --quiet --detach "$work/$1" "$2"
    (cd "$work/$1" && CARGO_TARGET_DIR="$work/target" cargo build --release --locked --quiet)
    cp "$work/target/release/exocarp" "$work/exocarp-$1"
    [ -f "$work/model.ply" ] || "$work/exocarp-$1" model anchor -o "$work/model.ply" --quiet
    local distance profile
    for distance in 2% -2%; do
        # Valgrind reads a % in the name of the file as a place for something else.
        profile=$work/profile${distance%\%}-$1
        valgrind --tool=callgrind --callgrind-out-file="$profile" \
            "$work/exocarp-$1" offset "$work/model.ply" -d "$distance" --resolution 48 --threads 1 --quiet \
            -o "$work/out.ply" 2>"$work/log" || { cat "$work/log" >&2; exit 1; }
        printf '%s %s\n' "$distance" "$(awk '/^(summary|totals):/ { print $2; exit }' "$profile")"
    done
}

measure old "$old" >"$work/old.txt"
measure new "$new" >"$work/new.txt"
printf '%-10s %16s %16s %9s\n' distance old new change
paste -d' ' "$work/old.txt" "$work/new.txt" |
    awk '{ printf "%-10s %16.0f %16.0f %+8.2f%%\n", $1, $2, $4, 100 * ($4 / $2 - 1) }'
