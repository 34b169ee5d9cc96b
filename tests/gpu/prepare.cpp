// prepare.cpp: Writes the input of the GPU suite with the full build: models of a volume, its voxels as
// .nvdb, and the CPU's pictures of both. vog_gpu_prepare VOLUME FOLDER
#include <fmt/core.h>
#include <nanovdb/util/IO.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "option_scene.h"
#include "pfm.h"
#include "render/reference/reference.h"
#include "render/splat/volume/volume_splat.h"
#include "render/trace/trace.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/field_maps.h"
#include "vog/ply.h"
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

void write_voxels(const std::filesystem::path& folder, const std::string& name,
                  const Volume& volume) {
    const VoxelGrid grid = voxel_grid(volume);
    const std::span<const std::byte> bytes = grid.bytes();
    auto buffer = nanovdb::HostBuffer::create(bytes.size());
    std::memcpy(buffer.data(), bytes.data(), bytes.size());
    nanovdb::GridHandle<nanovdb::HostBuffer> handle(std::move(buffer));
    nanovdb::io::writeGrid((folder / (name + ".nvdb")).string(), handle, nanovdb::io::Codec::NONE);
    const Camera camera = paper_view(world_box(volume));
    write_pfm(folder / (name + ".pfm"), render_reference({&grid, 1}, camera, kSize, kSize));
    write_camera(folder / (name + ".json"), camera);
}

DepthImage as_picture(const std::vector<float>& values) {
    DepthImage image(kOptionWidth, kOptionHeight);
    image.depth = values;
    return image;
}

/// Pictures of options: option_checks.cpp.
void write_options(const std::filesystem::path& folder, const Gaussians& model) {
    write_ply(folder / "options.ply", model);
    const Camera camera = option_camera(model);
    const int width = kOptionWidth, height = kOptionHeight;
    const auto write = [&](const std::string& name, const DepthImage& image) {
        write_pfm(folder / (name + ".pfm"), image);
    };
    write("boxes", render_trace(trace_scene(model, {kBoxSigma, 0}), camera, width, height));
    write("kappa", render_trace(trace_scene(model, {0, kKappa}), camera, width, height));
    const TraceScene scene = trace_scene(model);
    write("stop", render_trace(scene, camera, width, height, stopping_rays()));
    TraceOptions collect;
    collect.anyhit = AnyHit::collect;
    collect.hits_per_slab = 8;
    TraceReport report;
    (void)render_trace(scene, camera, width, height, collect, &report);
    std::ofstream counts(folder / "counts.json");
    counts << fmt::format("{{\"hits\": {}, \"slabs\": {}, \"most_slabs\": {}}}\n", report.hits,
                          report.slabs, report.most_slabs);
    if (!counts.flush()) throw Error((folder / "counts.json").string() + ": cannot write");

    const ScalarField& field = model.fields.scalar.front();
    const FieldMaps maps =
        render_field_trace(model, {field.name, FieldPart::value}, camera, width, height);
    write("column", as_picture(maps.column));
    // Where only the rims of supports are, means have no digits in floats.
    constexpr double kLeast = 1e-3;
    write("mean", as_picture(visible_values(maps, maps.mean, kLeast).value));
    write("deviation", as_picture(visible_values(maps, maps.deviation, kLeast).value));
    const ValueTransfer transfer = option_transfer(field, view_box(model).radius() / 50);
    for (const int slabs : {32, 70}) {
        const VolumeImage picture =
            render_volume_splat(model, field.name, transfer, camera, width, height,
                                {.slabs = slabs, .look = option_look(model)});
        for (const auto& [name, channel] :
             {std::pair{"r", &Rgba::r}, {"g", &Rgba::g}, {"b", &Rgba::b}, {"a", &Rgba::a}}) {
            DepthImage image(width, height);
            std::ranges::transform(picture.pixel, image.depth.begin(), channel);
            write(fmt::format("volume{}_{}", slabs, name), image);
        }
    }
    write("maximum",
          as_picture(render_maximum_splat(model, field.name, camera, width, height).value));
}

void prepare(const std::filesystem::path& file, const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder);
    const Volume volume = read_vdb(file);
    for (int lod = 1; lod <= 5; ++lod)
        write_model(folder, fmt::format("lod{}", lod), convert_paper(volume, paper_lod(lod)));
    for (const int block : {2, 4, 8})
        write_model(folder, fmt::format("moments{}", block),
                    convert_moments(volume, {.block_voxels = block}));
    write_options(folder, convert_moments(volume, {.block_voxels = 4, .own_field = "density"}));
    write_voxels(folder, "voxels", volume);
    Volume skewed = volume;
    Mat3& linear = skewed.world_from_index.linear;
    linear = linear * Mat3{{Vec3d{1, 0.3, 0}, Vec3d{0, 1.2, -0.2}, Vec3d{0.1, 0, 0.8}}};
    write_voxels(folder, "skewed", skewed);
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
