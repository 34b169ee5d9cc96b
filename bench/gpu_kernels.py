#!/usr/bin/env python3
"""Registers, shared memory and occupancy of the CUDA kernels, by the compiler, without a GPU.

usage: bench/gpu_kernels.py [--nvcc NVCC] [--optix OPTIX_ROOT [--frame VOG MODEL]] [ARCHITECTURE ...]     default: 75 86 89 90 120

With --optix, the operations and loads of each OptiX program in its PTX instead: the driver compiles them, so registers are
known on a card alone.

With --frame, the least that hits of a frame of MODEL at 1024 x 1024 in the paper view move and compute on OptiX's rays, and the
time that bounds on two cards: hits are counted by VOG's ray tracer (the same programs), operations and loads as above. Boxes that
rays meet beside their Gaussians are not counted.

Occupancy is the share of a multiprocessor's threads that fit beside each other, limited by registers, shared
memory, blocks and threads (CUDA C++ Programming Guide, "Technical Specifications per Compute Capability").
"""
import argparse
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
SOURCES = [ROOT / "src/render/gpu/cuda_splat.cu", ROOT / "src/render/gpu/chords/chord_kernels.cu"]
THREADS = 256  # of a block, kBlock
# Threads, blocks and bytes of shared memory of a multiprocessor; all have 65,536 registers.
PROCESSORS = {75: (1024, 16, 64 << 10), 86: (1536, 16, 100 << 10), 89: (1536, 24, 100 << 10),
              90: (2048, 32, 228 << 10), 120: (1536, 24, 100 << 10)}
REGISTERS = 65536
# Bytes a second of memory, operations a second in single and double precision (an fma is one), by NVIDIA's datasheets: GeForce RTX 4090
# Laptop GPU, 576 GB/s, 9,728 cores at the least boost of 1.455 GHz, 1/64 of that in double; H100 SXM, 3.35 TB/s, 67 and 34 TFLOPS.
CARDS = {"RTX 4090 laptop": (576e9, 9728 * 1.455e9, 9728 * 1.455e9 / 64), "H100 SXM": (3.35e12, 67e12 / 2, 34e12 / 2)}
# Programs of a hit and of a ray for each picture, and the bytes that a hit loads (Gaussian, light).
FRAMES = {"T": (("__intersection__gaussian", "__anyhit__accumulate"), "__raygen__accumulate", 64),
          "column alone, clips": (("__intersection__gaussian", "__anyhit__sums"), "__raygen__sums", 64),
          "by value": (("__intersection__gaussian", "__anyhit__slabs"), "__raygen__slabs", 128)}


def occupancy(architecture, registers, shared):
    threads, blocks, memory = PROCESSORS[architecture]
    # Registers are given out by 256 a warp, shared memory with 1 KB of the system's a block from 8.0 on.
    per_warp = (registers * 32 + 255) // 256 * 256
    reserved = 0 if architecture < 80 else 1024
    fit = min(threads // THREADS, blocks, REGISTERS // (per_warp * (THREADS // 32)), memory // max(shared + reserved, 1))
    return fit * THREADS / threads


def kernels(nvcc, architecture):
    """{kernel: (registers, bytes of shared memory, bytes of spills)}"""
    found, name, spills = {}, None, 0
    for source in SOURCES:
        with tempfile.TemporaryDirectory() as folder:
            made = subprocess.run([nvcc, "-std=c++17", "-O3", f"-I{ROOT}/src", f"-I{ROOT}/include",
                                   f"-gencode=arch=compute_{architecture},code=sm_{architecture}", "-Xptxas", "-v", "-c",
                                   str(source), "-o", f"{folder}/object.o"], capture_output=True, text=True)
        if made.returncode:
            sys.exit(f"{source.name} for sm_{architecture}: {made.stderr.strip().splitlines()[-1]}")
        for line in made.stderr.splitlines():
            if "Compiling entry function" in line:
                # An anonymous namespace's name ends in eight digits of a hash; the length of the kernel's follows.
                match = re.search(r"_cu_[0-9a-f]{8}\d+([a-z_]+_kernel)", line)
                name = match and match[1]
            elif match := re.search(r"(\d+) bytes spill stores", line):
                spills = int(match[1])
            elif name and (match := re.search(r"Used (\d+) registers", line)):
                shared = re.search(r"(\d+) bytes smem", line)
                found[name] = (int(match[1]), int(shared[1]) if shared else 0, spills)
                name = None
    return found


def programs(nvcc, optix):
    """{OptiX program: (double operations, float operations, loads of 16 bytes, other loads of global memory)}"""
    nanovdb = ["-I/usr/include"] if pathlib.Path("/usr/include/nanovdb").exists() else []
    made = subprocess.run([nvcc, "-std=c++17", "-O3", f"-I{ROOT}/src", f"-I{ROOT}/include", f"-I{optix}/include", *nanovdb,
                           "-arch=compute_75", "--ptx", str(ROOT / "src/render/gpu/optix/optix_programs.cu"), "-o", "-"],
                          capture_output=True, text=True)
    if made.returncode:
        sys.exit(f"optix_programs.cu: {made.stderr.strip().splitlines()[-1]}")
    found = {}
    for match in re.finditer(r"\.entry (\w+)\(.*?\n}\n", made.stdout, re.S):
        def count(pattern):
            return len(re.findall(pattern, match[0]))
        wide = count(r"\tld\.global\S*\.v4")
        found[match[1]] = (count(r"\t(?:fma|add|mul|sub|div|sqrt)\S*\.f64"), count(r"\t(?:fma|add|mul|sub|div|sqrt)\S*\.f32"),
                           wide, count(r"\tld\.global") - wide)
    return found


def print_frame(vog, model, counts):
    with tempfile.TemporaryDirectory() as folder:
        report = subprocess.run([vog, "render", model, "-o", f"{folder}/p.png", "--renderer", "trace", "--size", "1024", "--view",
                                 "paper", "--json"], capture_output=True, text=True)
    if report.returncode:
        sys.exit(f"{vog}: {report.stderr.strip()}")
    hits, rays = json.loads(report.stdout)["hits"], 1024 * 1024
    print(f"{hits:,} hits, {hits / rays:.1f} a ray\n")
    print("| picture | loads | operations, single | double | " + " | ".join(f"{card}: memory, single, double" for card in CARDS) + " |")
    print("|---|---|---|---|" + "---|" * len(CARDS))
    for picture, (of_hit, of_ray, loaded) in FRAMES.items():
        moved = hits * loaded
        single = hits * sum(counts[name][1] for name in of_hit) + rays * counts[of_ray][1]
        # Double operations of the intersection are of --set aabb-sigma alone.
        double = hits * counts[of_hit[1]][0] + rays * counts[of_ray][0]
        cells = [" , ".join(f"{1e3 * amount / rate:.2f}" for amount, rate in zip((moved, single, double), rates)).replace(" ,", ",")
                 + " ms" for rates in CARDS.values()]
        print(f"| {picture} | {moved / 1e6:.0f} MB | {single / 1e9:.2f} G | {double / 1e9:.2f} G | " + " | ".join(cells) + " |")


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("--nvcc", default="nvcc")
    options.add_argument("--optix", help="folder of OptiX's headers: count operations of its programs")
    options.add_argument("--frame", nargs=2, metavar=("VOG", "MODEL"), help="with --optix: bounds on the time of a frame")
    options.add_argument("architectures", nargs="*", type=int, default=sorted(PROCESSORS))
    arguments = options.parse_args()
    if arguments.frame and not arguments.optix:
        sys.exit("--frame: expected --optix, too")
    if arguments.frame:
        print_frame(*arguments.frame, programs(arguments.nvcc, arguments.optix))
        return
    if arguments.optix:
        print("| program | operations, double | float | loads of 16 bytes | other loads |\n|---|---|---|---|---|")
        for name, counts in programs(arguments.nvcc, arguments.optix).items():
            print(f"| `{name}` | " + " | ".join(map(str, counts)) + " |")
        return
    unknown = [a for a in arguments.architectures if a not in PROCESSORS]
    if unknown:
        sys.exit(f"architecture {unknown[0]}, expected {', '.join(map(str, sorted(PROCESSORS)))}")
    rows = {a: kernels(arguments.nvcc, a) for a in arguments.architectures}
    print("| kernel | " + " | ".join(f"sm_{a}" for a in rows) + " |")
    print("|---|" + "---|" * len(rows))
    for kernel in sorted({k for found in rows.values() for k in found}):
        cells = []
        for architecture, found in rows.items():
            registers, shared, spills = found[kernel]
            cells.append(f"{registers} registers, {shared / 1024:.1f} kB, {occupancy(architecture, registers, shared):.0%}"
                         + (f", {spills} B spilled" if spills else ""))
        print(f"| `{kernel}` | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
