#!/usr/bin/env bash
# Checks the GPU sources against the headers of a CUDA toolkit without its compiler: host code by GCC, kernels and OptiX
# programs by Clang's front end, for host and device. No object is written.
#
# usage: tests/gpu/check_headers.sh CUDA_FOLDER [OPTIX_FOLDER]
#   CUDA_FOLDER   with include/ (runtime, nvcc's crt/, CUB) and nvvm/libdevice/
#   OPTIX_FOLDER  with include/optix.h; without it OptiX's sources are left out
set -euo pipefail
if (($# < 1 || $# > 2)); then
    echo "usage: $0 CUDA_FOLDER [OPTIX_FOLDER]" >&2
    exit 2
fi
cuda=$(realpath "$1") optix=${2:+$(realpath "$2")}
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Clang includes a header of cuRAND, and its wrapper leaves a macro that libstdc++ has as an attribute.
touch "$folder/curand_mtgp32_kernel.h"
echo '#undef __noinline__' >"$folder/after_cuda.h"
common=(-std=c++20 -fsyntax-only -DVOG_CUDA -Iinclude -Isrc -isystem "$cuda/include" -isystem "$folder")
[[ -z $optix ]] || common+=(-DVOG_OPTIX -isystem "$optix/include")
clang=$(command -v clang++-16 || command -v clang++)
count=0
while read -r source; do
    [[ $source != */optix/* || -n $optix ]] || continue
    if [[ $source == *.cpp ]]; then
        g++ "${common[@]}" "$source"
    else
        only=()
        [[ $source != */optix_programs.cu ]] || only=(--cuda-device-only)
        "$clang" "${common[@]}" -x cuda "${only[@]}" --cuda-path="$cuda" --cuda-gpu-arch=sm_75 -Wno-unknown-cuda-version \
            -Xclang -fcuda-allow-variadic-functions -include "$folder/after_cuda.h" "$source"
    fi
    count=$((count + 1))
done < <(git ls-files 'src/render/gpu/*.cpp' 'src/render/gpu/*.cu')
version=$(sed -n 's/^#define CUDART_VERSION  *//p' "$cuda/include/cuda_runtime_api.h")
echo "$count sources agree with the headers of CUDA $((version / 1000)).$((version % 1000 / 10))${optix:+ and OptiX}"
