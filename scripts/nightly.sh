#!/usr/bin/env bash
# Checks that take longer than a change may wait for: scripts/nightly.sh. What .ci/run leaves to the night:
#   tests       more values of parameters (VOG_NIGHTLY: 1, 2, 3, 5 and 8 ranks of vog-mpi, pages' pictures of a million pixels), tests
#               of the label nightly (the Python package under NumPy 2 among them), every pair of options in a run of its own
#               (VOG_ALL_PAIRS); effects of the options of vog view and vog-mpi, and of every option on conversions that measure
#               their errors and on evaluations of a volume (VOG_ALL_EFFECTS)
#   sanitizers  tests that every change runs without them alone: conversions that measure errors, more pictures of voxels, most sessions of the window
#               (`night` in tests/CMakeLists.txt), and all of them where 70 minutes are over before
#   emulation   the GPU renderers on host memory, compiled by GCC, which inlines other functions of the device than Clang does
#   gpu         the suite for GPUs, compiled by nvcc where there is one: every change compiles its device code alone
#   threads     the parallel stages under the thread sanitizer
#   packages    a wheel for each Python that this machine has and the Debian package, each on a bare system
#   fuzz        every target for two minutes, from a new seed
set -euo pipefail
cd "$(dirname "$0")/.."
stage() { echo "[$((SECONDS / 60)) min] $1"; }
export VOG_NIGHTLY=1 VOG_ALL_PAIRS=1 VOG_ALL_EFFECTS=1

stage "tests"
scripts/test.sh -DVOG_WERROR=ON
ctest --preset nightly

stage "sanitizers: tests that every change runs without them, and those that slow machines leave out"
scripts/build.sh sanitize -DVOG_WERROR=ON
export UBSAN_OPTIONS=print_stacktrace=1
ctest --preset sanitize
tests/emulation/coverage.py build/sanitize
ctest --preset sanitize-nightly

stage "emulation: the GPU renderers on host memory, by GCC"
scripts/build.sh emulation -DVOG_WERROR=ON
ctest --preset emulation -R emulated_gpu

if command -v nvcc >/dev/null; then
    stage "gpu: the suite for GPUs, compiled"
    mkdir -p build/gpu-data
    VOG_BUILD_ONLY=vog_gpu_suite VOG_GPU_BUILD=build/gpu-compiled VOG_CUDA_ARCHITECTURES=75 VOG_WERROR=ON tests/gpu/run.sh build/gpu-data
fi

stage "threads: the parallel stages under the thread sanitizer"
scripts/build.sh threads
ctest --preset threads

stage "packages: a wheel for each Python, the Debian package"
VOG_WERROR=ON scripts/wheel.sh
scripts/deb.sh

stage "fuzz: every target for two minutes"
scripts/fuzz.sh all 120
