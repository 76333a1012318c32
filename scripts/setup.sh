#!/bin/bash
# setup.sh [tests]: installs the Debian packages that exocarp needs and that are missing, with `tests` those of
# the tests, too. It says nothing when all are there.
# It works as root or through sudo, and without either it says what to install.
set -euo pipefail

fail() {
    echo "setup: $1" >&2
    exit 1
}

# rustup's cargo may not be on the PATH of a shell that was open when it was installed.
command -v cargo >/dev/null || PATH="$HOME/.cargo/bin:$PATH"
command -v cargo >/dev/null || fail "cargo is missing; install a Rust toolchain first (https://rustup.rs)."

# The C++ side: compiler, OpenVDB 10 or later, what its headers include.
packages=(g++ make libopenvdb-dev libtbb-dev libboost-dev libblosc-dev)
# The tests open our .vdb files with OpenVDB's Python module.
[ "${1:-}" != tests ] || packages+=(python3-openvdb python3-numpy)

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    # Not a Debian: the build looks for OpenVDB itself and says what is missing.
    command -v c++ >/dev/null || fail "no C++ compiler was found; install one, and OpenVDB 10 to 13 with its headers."
    exit 0
fi

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f '${Status}' "$package" 2>/dev/null || true)
    [ "$status" = "install ok installed" ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

if [ "$(id -u)" -eq 0 ]; then
    as_root=()
elif command -v sudo >/dev/null && { sudo -n true 2>/dev/null || [ -t 0 ]; }; then
    as_root=(sudo)
else
    fail "these packages are missing and only root can install them: ${missing[*]} (run: apt-get install ${missing[*]})."
fi

echo "setup: installing ${missing[*]}"
# Both wait for the network most of the time; where this fails, the build says why.
cargo fetch --quiet --locked 2>/dev/null &
run() { ${as_root[@]+"${as_root[@]}"} env DEBIAN_FRONTEND=noninteractive apt-get -qq "$@" </dev/null >/dev/null; }
# The lists of a fresh machine may be empty or old: fetch them only if installing does not work as it is.
run install -y --no-install-recommends "${missing[@]}" 2>/dev/null ||
    { run update && run install -y --no-install-recommends "${missing[@]}"; } ||
    fail "installing ${missing[*]} failed; run apt-get install ${missing[*]} to see why."
wait
