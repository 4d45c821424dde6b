# shellcheck shell=sh
# Read by studio.sh and test.sh: find Python, make the environment, install what pyproject.toml lists.
# POSIX sh, because Debian's sh is dash and macOS has bash 3.2. Everything said goes to stderr:
# stdout belongs to the verbs.

say() {
    printf '%s\n' "$*" >&2
}

stop() {
    say "$*"
    exit 1
}

# install_debian SENTENCE OTHERWISE PACKAGE…: SENTENCE says what is missing, OTHERWISE what to do where there is no apt.
install_debian() {
    missing=$1
    otherwise=$2
    shift 2
    command -v apt-get >/dev/null 2>&1 || stop "$missing: $otherwise, then start again."
    if [ "$(id -u)" = 0 ]; then
        as_root=
    elif command -v sudo >/dev/null 2>&1 && sudo -n true >/dev/null 2>&1; then
        as_root="sudo -n"
    else
        stop "$missing: run 'sudo apt install $*', then start again."
    fi
    say "$missing: installing $* from the packages of this system."
    log=$(mktemp)
    # The package lists of a fresh system are empty or old: when the first try fails, fetch them and try again.
    if ! $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@" >"$log" 2>&1 </dev/null &&
        ! { $as_root apt-get update >"$log" 2>&1 </dev/null &&
            $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "$@" >>"$log" 2>&1 </dev/null; }; then
        tail -n 20 "$log" >&2
        rm -f "$log"
        stop "$missing, and the packages $* could not be installed for the reason above: install them by hand, then start again."
    fi
    rm -f "$log"
}

suitable() {
    "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' >/dev/null 2>&1 </dev/null
}

can_make_environments() {
    "$1" -c 'import ensurepip, venv' >/dev/null 2>&1 </dev/null
}

# A name on the path may be a pyenv shim that only fails, so each candidate is run.
find_python() {
    python=
    for candidate in python3.13 python3.12 python3.11 python3 python; do
        if suitable "$candidate"; then
            [ -n "$python" ] || python=$candidate
            if can_make_environments "$candidate"; then
                python=$candidate
                return
            fi
        fi
    done
    [ -n "$python" ]
}

find_complete_python() {
    if ! find_python; then
        found=$(python3 -c 'import sys; print("%d.%d is too %s" % (*sys.version_info[:2], "old" if sys.version_info < (3, 11) else "new"))' 2>/dev/null </dev/null) || found="none was found"
        install_debian "Python 3.11, 3.12 or 3.13 is needed and $found" "install one, for example from python.org" python3 python3-venv
        find_python || stop "Python 3.11, 3.12 or 3.13 is needed and this system's packages have none of them: install one, then start again."
    fi
    if ! can_make_environments "$python"; then
        package=$("$python" -c 'import sys; print("python%d.%d-venv" % sys.version_info[:2])')
        install_debian "$python cannot make environments (the module ensurepip is missing)" "install the whole of Python" "$package"
        can_make_environments "$python" || stop "$python still cannot make environments: install $package by hand, then start again."
    fi
}

has_libraries() {
    [ "$(uname)" != Linux ] ||
        "$venv/bin/python" -c 'import ctypes, sys; [ctypes.CDLL(name) for name in sys.argv[1:]]' "$@" >/dev/null 2>&1
}

# needs_window: what Qt wants from the system; the verbs do without.
needs_window() {
    has_libraries libglib-2.0.so.0 libEGL.so.1 libGL.so.1 libdbus-1.so.3 libfontconfig.so.1 libxkbcommon.so.0 ||
        install_debian "The window needs libraries that are missing (libEGL and others)" "install those of Qt 6" \
            libglib2.0-0 libegl1 libgl1 libdbus-1-3 libfontconfig1 libxkbcommon0 fonts-dejavu-core
    has_libraries libxkbcommon-x11.so.0 libxcb-cursor.so.0 libxcb-icccm.so.4 libxcb-keysyms.so.1 libxcb-shape.so.0 ||
        install_debian "The window needs libraries of X11 that are missing (xcb-cursor and others)" "install those of Qt 6" \
            libxkbcommon-x11-0 libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1 libxcb-shape0
}

# prepare run|dev: afterwards $venv/bin/python has everything.
prepare() {
    venv=${KINETAG_VENV:-$root/.venv}
    case $venv in /*) ;; *) venv=$PWD/$venv ;; esac
    if ! suitable "$venv/bin/python"; then
        find_complete_python
        if [ -e "$venv" ] && [ ! -e "$venv/pyvenv.cfg" ]; then
            stop "The folder $venv is in the way: move it, or name another with KINETAG_VENV."
        fi
        say "Making an environment with $("$python" -V) in $venv."
        "$python" -m venv --clear "$venv" >&2 || stop "The environment could not be made in $venv for the reason above."
    fi
    "$venv/bin/python" -I "$root/installers/environment.py" "$1" "$venv" || exit 1
}
