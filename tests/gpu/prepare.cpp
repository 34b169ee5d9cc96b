// prepare.cpp: Writes the input of the GPU suite with the full build: models of a volume, its voxels as
// .nvdb, and the CPU's pictures of both. vog_gpu_prepare VOLUME FOLDER
#include <fmt/core.h>
#include <nanovdb/util/IO.h>

#include <cstring>

#include "pfm.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/ply.h"
#include "vog/reference.h"
#include "vog/trace.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

constexpr int kSize = 512;  ///< width and height of the pictures, pixels

void write_model(const std::filesystem::path& folder, const std::string& name,
                 const Gaussians& model) {
    write_ply(folder / (name + ".ply"), model);
    const Camera camera = paper_view(view_box(model));
    write_pfm(folder / (name + ".pfm"), render_trace(trace_scene(model), camera, kSize, kSize));
    fmt::print("{}: {} Gaussians\n", name, model.size());
}

void write_voxels(const std::filesystem::path& folder, const Volume& volume) {
    const VoxelGrid grid = voxel_grid(volume);
    const std::span<const std::byte> bytes = grid.bytes();
    auto buffer = nanovdb::HostBuffer::create(bytes.size());
    std::memcpy(buffer.data(), bytes.data(), bytes.size());
    nanovdb::GridHandle<nanovdb::HostBuffer> handle(std::move(buffer));
    nanovdb::io::writeGrid((folder / "voxels.nvdb").string(), handle, nanovdb::io::Codec::NONE);
    const Camera camera = paper_view(world_box(volume));
    write_pfm(folder / "voxels.pfm", render_reference({&grid, 1}, camera, kSize, kSize));
    write_camera(folder / "voxels.json", camera);
}

void prepare(const std::filesystem::path& file, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    const Volume volume = read_vdb(file);
    for (int lod = 1; lod <= 5; ++lod)
        write_model(folder, fmt::format("lod{}", lod), convert_paper(volume, paper_lod(lod)));
    for (const int block : {2, 4, 8})
        write_model(folder, fmt::format("moments{}", block),
                    convert_moments(volume, {.block_voxels = block}));
    write_voxels(folder, volume);
}

}  // namespace

}  // namespace vog::test

int main(int count, char** arguments) {
    if (count != 3) {
        fmt::print(stderr, "usage: vog_gpu_prepare VOLUME.vdb FOLDER\n");
        return 2;
    }
    try {
        vog::test::prepare(arguments[1], arguments[2]);
    } catch (const std::exception& error) {
        fmt::print(stderr, "vog_gpu_prepare: {}\n", error.what());
        return 1;
    }
}
