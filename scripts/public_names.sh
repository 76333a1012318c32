#!/bin/bash
# Lists the library's public names from the documentation that rustdoc writes, and counts them. With
# a number, fails when there are that many or more: scripts/public_names.sh 100
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
cargo doc --quiet --no-deps --locked --lib
names=$(grep -o '<li><a href="[^"]*">[^<]*</a>' "${CARGO_TARGET_DIR:-target}/doc/exocarp/all.html" |
    sed 's/.*">//; s/<.*//' | sort)
echo "$names"
count=$(wc -l <<<"$names")
echo "$count public names"
[ "$count" -lt "${1:-1000000}" ]
