// optix_film.cpp: Output buffers, table of the transfer function, mean over subframes.
#include "render/gpu/optix/optix_film.h"

#include <algorithm>

namespace vog::gpu {

namespace {

/// Steps of V in the table: neighbouring colours differ by less than half an 8-bit step for transfer
/// functions with slopes below 16 a unit of V.
constexpr int kTableEntries = 4096;

std::vector<device::Float4> table_of(const TransferFunction& tf) {
    std::vector<device::Float4> table;
    for (int n = 0; n < kTableEntries; ++n) {
        const Rgba c = color_at(tf, static_cast<float>(n) / (kTableEntries - 1));
        table.push_back({c.r, c.g, c.b, c.a});
    }
    return table;
}

}  // namespace

void OptixFilm::load(int width, int height) {
    width_ = width, height_ = height, progressive_ = false;
    depth_.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                   "the picture");
}

void OptixFilm::load(int width, int height, const GpuShading& shading) {
    load(width, height);
    progressive_ = true;
    accumulation_.reserve(static_cast<std::size_t>(width) * static_cast<std::size_t>(height),
                          "the sum of subframes");
    table_ = GpuArray<device::Float4>(table_of(shading.tf), "the transfer function");
    const Rgba b = shading.options.background;
    colors_ = {table_.data(),
               kTableEntries,
               static_cast<float>(shading.extinction),
               {b.r, b.g, b.b, b.a},
               shading.options.blend ? 1 : 0};
}

device::Film OptixFilm::film(std::uint32_t subframe) const {
    device::Film film{};
    film.depth = depth_.data();
    film.accumulation = progressive_ ? accumulation_.data() : nullptr;
    film.depth_unit = depth_unit_;
    film.subframe = subframe;
    film.colors = colors_;
    return film;
}

DepthImage OptixFilm::depth() const {
    DepthImage image(width_, height_);
    depth_.copy_to(image.depth.data(), image.depth.size(), "fetching the picture");
    return image;
}

Image OptixFilm::mean(int subframes) const {
    Image image(width_, height_);
    std::vector<device::Float4> sum(image.pixel.size());
    accumulation_.copy_to(sum.data(), sum.size(), "fetching the picture");
    const float share = 1 / static_cast<float>(subframes);
    std::transform(sum.begin(), sum.end(), image.pixel.begin(), [&](const device::Float4& c) {
        return Rgba{share * c.x, share * c.y, share * c.z, share * c.w};
    });
    return image;
}

}  // namespace vog::gpu
