#!/bin/bash
# Runs every test that can run here, and says at the end which did not and why.
#
#   scripts/test.sh [OPTIONS OF CARGO TEST]
#
# A test that needs more than the toolchain is #[ignore]d, with the reason, in a module that is named
# after its need:
#   needs_models    the test models, in the directory EXOCARP_MODELS (or ../shared/models)
#   needs_python    python3 with OpenVDB's module
#   needs_browser   Chromium
#   long            minutes, with EXOCARP_HEAVY=1
# So `cargo test` alone names what it leaves out, and here those whose need is met are run, too.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

has_python() {
    local python module
    for python in /usr/bin/python3 python3; do
        for module in pyopenvdb openvdb; do
            "$python" -c "import $module" 2>/dev/null && return
        done
    done
    return 1
}

has_browser() {
    local name
    for name in chromium chromium-browser google-chrome google-chrome-stable; do
        command -v "$name" >/dev/null && return
    done
    return 1
}

# A checkout of the test models may lie beside this one.
if [ -z "${EXOCARP_MODELS:-}" ] && [ -d ../shared/models ]; then
    EXOCARP_MODELS=$(realpath ../shared/models)
    export EXOCARP_MODELS
fi

unmet=() reasons=()
leave_out() {
    unmet+=("$1::")
    reasons+=("$2")
}
[ -d "${EXOCARP_MODELS:-}" ] || leave_out needs_models "EXOCARP_MODELS names no directory, and there is no ../shared/models"
has_python || leave_out needs_python "no python3 with pyopenvdb or openvdb"
has_browser || leave_out needs_browser "no Chromium"
[ "${EXOCARP_HEAVY:-}" = 1 ] || leave_out long "takes minutes: EXOCARP_HEAVY=1, or make test-full"

tests=(cargo test --locked "$@" --lib --bins --tests --examples)
"${tests[@]}" -- --include-ignored "${unmet[@]/#/--skip=}"
cargo test --locked "$@" --doc

echo
if [ "${#unmet[@]}" -eq 0 ]; then
    echo "Every test was run."
    exit
fi
# The names come from the test programs themselves, so no test can be left out unsaid.
ignored="$("${tests[@]}" --quiet -- --list --ignored | sed -n 's/: test$//p')"
echo "Not run:"
left="$ignored"
for n in "${!unmet[@]}"; do
    names="$(grep -F "${unmet[$n]}" <<<"$left" || true)"
    left="$(grep -vF "${unmet[$n]}" <<<"$left" || true)"
    [ -z "$names" ] || sed "s|^|  |; s|\$|: ${reasons[$n]}|" <<<"$names"
done
