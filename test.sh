#!/bin/sh
# Set everything up and run the checks: ruff, mypy, import-linter and the tests.
#   ./test.sh                       all of it, without the long tests, the peers and the benchmarks
#   ./test.sh --firmware            only the tests that compile the firmware
#   ./test.sh --long                only the tests that take minutes
#   ./test.sh --peers               only the tests in which other programs read what we wrote
#   ./test.sh --benchmarks          only the tests that print figures
#   ./test.sh tests/core -k walk    only these tests: the words go to pytest
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
# shellcheck source=installers/environment.sh
. "$root/installers/environment.sh"

choose() {
    markers=${markers:+$markers or }$1
}

markers=
words=$#
while [ "$words" -gt 0 ]; do
    word=$1
    shift
    case $word in
    --firmware) choose firmware ;;
    --long) choose long ;;
    --peers) choose peers ;;
    --benchmarks) choose benchmark ;;
    *) set -- "$@" "$word" ;;
    esac
    words=$((words - 1))
done

has_compiler() {
    printf '#include <stdint.h>\n#include <string.h>\nint main(void) { return 0; }\n' | gcc -x c -fsyntax-only - >/dev/null 2>&1
}

needs_compiler() {
    has_compiler || install_debian "The tests compile C and gcc is missing" "install gcc (macOS: xcode-select --install)" gcc libc6-dev
    has_compiler || stop "gcc is there but cannot compile: install it anew, then start again."
}

has_blender_libraries() {
    has_libraries libX11.so.6 libXrender.so.1 libXfixes.so.3 libXi.so.6 libxkbcommon.so.0 libSM.so.6 libGL.so.1
}

needs_peers() {
    if ! command -v node >/dev/null 2>&1 || ! command -v npm >/dev/null 2>&1; then
        install_debian "The peers read our files with Node.js, which is missing" "install Node.js" nodejs npm
    fi
    if ! has_blender_libraries; then
        install_debian "Blender, which reads our files, needs libraries that are missing" "install those of X11" \
            libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libgl1
    fi
}

failed=
stage() {
    name=$1
    shift
    say "== $name"
    started=$(date +%s)
    if "$@"; then
        say "== $name: passed in $(($(date +%s) - started)) s"
    else
        say "== $name: FAILED in $(($(date +%s) - started)) s"
        failed="$failed $name"
    fi
}

needs_compiler
prepare dev
needs_window
case $markers in *peers*) needs_peers ;; esac
cd "$root"
tool() {
    "$venv/bin/python" -m "$@"
}

# Fetched before the tests, so that their time limits are about reading and not about the network.
case $markers in *peers*) stage "setting up the peers" "$venv/bin/python" tests/peers/environments.py ;; esac

if [ -n "$markers" ]; then
    stage "pytest ($markers)" tool pytest -m "$markers" "$@"
elif [ $# -gt 0 ]; then
    stage pytest tool pytest "$@"
else
    stage ruff tool ruff check
    stage mypy tool mypy
    stage import-linter "$venv/bin/lint-imports" --no-logo
    # Journeys run in real time, some at a thousand packets a second: nothing else runs beside them.
    stage pytest tool pytest -n auto --ignore=tests/journeys
    stage journeys tool pytest tests/journeys
fi
[ -z "$failed" ] || stop "Failed:$failed"
