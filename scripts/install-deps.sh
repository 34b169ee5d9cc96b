#!/usr/bin/env bash
# Installs Debian 12 packages that are missing: scripts/install-deps.sh [command|all|peers|sanitize|docs]. Default: all.
#   command  enough to build the command `vog` (scripts/demo.sh)
#   all      window, Python package, vog-mpi, tests, benches and checks as well
#   peers    programs and Python packages that tests hand files to, and skip aloud without
#   sanitize the compiler with the sanitizers and libFuzzer as well (scripts/build.sh sanitize, scripts/fuzz.sh)
#   docs     the documents' site alone (scripts/docs.sh)
# Runs as root or with sudo.
set -euo pipefail

packages=(
    # build
    g++ cmake ninja-build pkg-config ccache
    # volumes, threads, text, images
    libopenvdb-dev libnanovdb-dev libtbb-dev libhwy-dev libboost-iostreams-dev libblosc-dev zlib1g-dev libzstd-dev
    libxxhash-dev
    libcli11-dev libfmt-dev nlohmann-json3-dev libpng-dev libopenexr-dev libimath-dev
    # ray tracing
    libembree-dev
    # single formats, without which vog refuses their files: TIFF, FITS, HDF5
    libtiff-dev libcfitsio-dev libhdf5-dev
    # vog serve; scripts of vog page
    libcpp-httplib-dev esbuild
)
all_packages=(
    # window: OpenGL, also without a display or a graphics card
    libglfw3-dev libimgui-dev libepoxy-dev libegl-dev libgl1-mesa-dri libegl-mesa0 fonts-dejavu-core xvfb xauth
    # tests of the page for browsers, and of its modules without one
    chromium nodejs python3
    # Python package and its tests; the stubs are checked by mypy, a notebook is run by Jupyter
    python3-nbclient python3-ipykernel python3-dev python3-numpy python3-pytest python3-pip python3-venv mypy python3-mypy
    # clusters
    libopenmpi-dev openmpi-bin
    # tests, benches, checks of format and house
    libgtest-dev libbenchmark-dev clang-format universal-ctags
)
case ${1:-all} in
    command) ;;
    all) packages+=("${all_packages[@]}") ;;
    sanitize) packages+=("${all_packages[@]}" clang-16 libclang-rt-16-dev llvm-16) ;;
    # shells; older processors; units, scans and stacks, VTK, plots, files that only Python reads
    peers) packages=(zsh fish qemu-user groff python3-astropy python3-pint python3-xarray python3-nibabel python3-tifffile python3-vtk9
        python3-matplotlib python3-h5py python3-netcdf4 python3-pydicom python3-zarr) ;;
    docs) packages=(mkdocs) ;;
    *) echo "install-deps: set '$1', expected command, all, peers, sanitize or docs" >&2; exit 2 ;;
esac

missing=()
for package in "${packages[@]}"; do
    status=$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)
    [[ $status == "install ok installed" ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

as_root=()
if [[ $(id -u) -ne 0 ]]; then
    command -v sudo >/dev/null || { echo "install-deps: needs root or sudo to install: ${missing[*]}" >&2; exit 1; }
    as_root=(sudo)
fi
echo "install-deps: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    "${missing[@]}" >/dev/null
