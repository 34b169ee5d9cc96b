// splat_files.cpp: the format of a file of splats, by its extension; 3DGS's and volprim's PLY.
#include "io/exchange/splat_files.h"

#include <fmt/core.h>

#include <cmath>
#include <numbers>

#include "core/atomic_file.h"
#include "io/exchange/splat_frame.h"
#include "io/exchange/splat_models.h"
#include "io/file_extension.h"
#include "vog/error.h"

namespace vog {

using namespace exchange;

namespace {

/// Header of a PLY of float32 properties.
std::string ply_header(const std::string& comment, std::size_t count,
                       std::span<const char* const> properties) {
    std::string text = "ply\nformat binary_little_endian 1.0\ncomment " + comment + "\n";
    text += fmt::format("element vertex {}\n", count);
    for (const char* name : properties) text += fmt::format("property float {}\n", name);
    return text + "end_header\n";
}

template <class Row>
void write_rows(std::ofstream& out, std::size_t count, const Row& row) {
    for (std::size_t i = 0; i < count; ++i) {
        const auto numbers = row(i);
        out.write(reinterpret_cast<const char*>(numbers.data()), sizeof numbers);
    }
}

void write_ply_splats(std::ofstream& out, const Splats& splats, const std::string& frame) {
    constexpr const char* kProperties[] = {
        "x",       "y",       "z",       "nx",      "ny",    "nz",    "f_dc_0", "f_dc_1", "f_dc_2",
        "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2",  "rot_3"};
    out << ply_header(
        "3D Gaussian splatting: scales are logarithms, opacity is a logit, f_dc spherical "
        "harmonics; x right, y down, z front\ncomment " +
            std::string(kFrameKey) + " " + frame,
        splats.size(), kProperties);
    write_rows(out, splats.size(), [&](std::size_t i) {
        const Vec3f m = splats.mean[i], s = splats.scale[i], dc = harmonics(splats.color[i]);
        const Quat q = splats.rotation[i];
        const Vec3f size{std::log(s.x), std::log(s.y), std::log(s.z)};
        const float logit = std::log(splats.opacity[i] / (1 - splats.opacity[i]));
        return std::array<float, 17>{m.x,   m.y,    m.z,    0,      0,   0,   dc.x, dc.y, dc.z,
                                     logit, size.x, size.y, size.z, q.w, q.x, q.y,  q.z};
    });
}

}  // namespace

Vec3f exchange::harmonics(Vec3f color) {
    // The constant harmonic is 1 / (2 sqrt(pi)); renderers add 1/2.
    const float factor = 2 * std::sqrt(std::numbers::pi_v<float>);
    return {factor * (color.x - 0.5f), factor * (color.y - 0.5f), factor * (color.z - 0.5f)};
}

void write_splats(const std::filesystem::path& file, const Splats& splats, Vec3d up) {
    if (splats.size() == 0)
        throw Error(fmt::format("{}: no splats, expected at least one", file.string()));
    const std::string extension = lower_extension(file);
    void (*write)(std::ofstream&, const Splats&, const std::string&) =
        extension == ".ply"    ? write_ply_splats
        : extension == ".spz"  ? write_spz
        : extension == ".glb"  ? write_glb
        : extension == ".usda" ? write_usda
                               : nullptr;
    if (extension == ".usdc" || extension == ".usd")
        throw Error(fmt::format("{}: OpenUSD is written as text, expected {}; then usdcat {} -o {}",
                                file.string(), text_layer(file), text_layer(file), file.string()));
    if (!write)
        throw Error(fmt::format("{}: extension '{}', expected .ply, .spz, .glb or .usda (splats)",
                                file.string(), extension));
    constexpr std::size_t kMostGlb = (std::uint64_t{1} << 32) / 64;  // lengths of 32 bits
    if (extension == ".glb" && splats.size() > kMostGlb)
        throw Error(fmt::format("{}: {} splats, expected at most {}", file.string(), splats.size(),
                                kMostGlb));
    const Splats upright =
        turned(splats, turn_of(up, extension == ".ply" ? Upright::minus_y : Upright::y));
    if (extension == ".spz") check_spz(upright, file.string());
    write_file(file, [&](std::ofstream& out) { write(out, upright, frame_text(splats, up)); });
}

void write_volprim(const std::filesystem::path& file, const Gaussians& model, double extinction) {
    validate(model);
    if (!(extinction > 0) || !std::isfinite(extinction))
        throw Error(fmt::format("extinction {}, expected > 0", extinction));
    constexpr const char* kProperties[] = {"x",       "y",       "z",     "scale_0",
                                           "scale_1", "scale_2", "rot_0", "rot_1",
                                           "rot_2",   "rot_3",   "sigmat"};
    const double beside = mass_within(3);  // of the kernel that volprim cuts
    if (model.size() == 0)
        throw Error(fmt::format("{}: no Gaussians, expected at least one", file.string()));
    for (std::size_t i = 0; i < model.size(); ++i)
        if (!std::isfinite(static_cast<float>(extinction * mass(model, i) / beside)))
            throw Error(fmt::format(
                "{}: Gaussian {}: extinction times mass is {:.3g}, expected within floats",
                file.string(), i, extinction * mass(model, i)));
    write_file(file, [&](std::ofstream& out) {
        out << ply_header("volprim: scales are logarithms, sigmat times a Gaussian of unit mass",
                          model.size(), kProperties);
        write_rows(out, model.size(), [&](std::size_t i) {
            const Vec3f m = vec_cast<float>(world_mean(model, i)), s = model.scale[i];
            const Quat q = model.axis_aligned() ? Quat{} : model.rotation[i];
            return std::array<float, 11>{m.x,
                                         m.y,
                                         m.z,
                                         std::log(s.x),
                                         std::log(s.y),
                                         std::log(s.z),
                                         q.w,
                                         q.x,
                                         q.y,
                                         q.z,
                                         static_cast<float>(extinction * mass(model, i) / beside)};
        });
    });
}

}  // namespace vog
