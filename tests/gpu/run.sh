#!/usr/bin/env bash
# Builds the GPU renderers and runs their accuracy suite, on any machine with CUDA 12, cmake, a C++
# compiler and OptiX's headers (OptiX_ROOT), beside the folder that tests/gpu/prepare.sh made.
# tests/gpu/run.sh [FOLDER, default gpu-data] [arguments of vog_gpu_suite]
# Without OptiX_ROOT only the CUDA renderer is built, with a message. VOG_BUILD_ONLY: a target to build, without running anything: vog_gpu_suite, or
# vog_gpu_suite_cuda for device code alone.
set -euo pipefail
cd "$(dirname "$0")/../.."

folder=$(realpath "${1:-gpu-data}")
shift || true
build=${VOG_GPU_BUILD:-build/gpu-suite}
optix=(-UVOG_OPTIX_INCLUDE -DVOG_OPTIX=ON "-DOptiX_ROOT=${OptiX_ROOT:-}")
if [[ ! -f ${OptiX_ROOT:-}/include/optix.h ]]; then
    echo "tests/gpu/run.sh: no OptiX headers in '${OptiX_ROOT:-}' (OptiX_ROOT): the CUDA renderer alone"
    optix=(-DVOG_OPTIX=OFF)
fi
architectures=(-UCMAKE_CUDA_ARCHITECTURES)
if [[ -n ${VOG_CUDA_ARCHITECTURES:-} ]]; then
    architectures=("-DCMAKE_CUDA_ARCHITECTURES=$VOG_CUDA_ARCHITECTURES")
fi
cmake -S tests/gpu -B "$build" -DVOG_GPU_HEADERS="$folder/include" "${optix[@]}" "${architectures[@]}" \
      -DVOG_WERROR="${VOG_WERROR:-OFF}"
cmake --build "$build" -j "$(nproc)" --target "${VOG_BUILD_ONLY:-all}"
[[ ${VOG_BUILD_ONLY:-} ]] && exit 0
"$build/vog_gpu_suite" "$folder" "$@"
