// ply_nodes.cpp: rows of the element node, block by block.
#include "io/ply_nodes.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <istream>
#include <ostream>

namespace vog {

namespace {

constexpr std::size_t kBlock = 1 << 16;

std::size_t words_per_node(bool axis_aligned) { return axis_aligned ? 11 : 15; }

}  // namespace

std::vector<std::string> node_properties(bool axis_aligned) {
    std::vector<std::string> names = {"float x",       "float y",       "float z",
                                      "float scale_0", "float scale_1", "float scale_2"};
    if (!axis_aligned)
        for (int n = 0; n < 4; ++n) names.push_back(fmt::format("float rot_{}", n));
    for (const char* name :
         {"float density", "float radius", "float error", "uint first", "uint count"})
        names.emplace_back(name);
    return names;
}

std::size_t bytes_per_node(bool axis_aligned) { return 4 * words_per_node(axis_aligned); }

std::string node_header(const Hierarchy& hierarchy) {
    if (hierarchy.empty()) return {};
    std::string text = fmt::format("element node {}\n", hierarchy.size());
    for (const std::string& name : node_properties(hierarchy.nodes.axis_aligned()))
        text += "property " + name + "\n";
    return text;
}

void write_nodes(std::ostream& out, const Hierarchy& hierarchy) {
    const Gaussians& nodes = hierarchy.nodes;
    std::vector<float> rows;
    for (std::size_t begin = 0; begin < hierarchy.size(); begin += kBlock) {
        const std::size_t end = std::min(begin + kBlock, hierarchy.size());
        rows.clear();
        const auto put = [&rows](auto... values) { (rows.push_back(values), ...); };
        for (std::size_t n = begin; n < end; ++n) {
            put(nodes.mean[n].x, nodes.mean[n].y, nodes.mean[n].z);
            put(nodes.scale[n].x, nodes.scale[n].y, nodes.scale[n].z);
            if (!nodes.axis_aligned()) {
                const Quat q = nodes.rotation[n];
                put(q.w, q.x, q.y, q.z);
            }
            put(nodes.density[n], hierarchy.radius[n], hierarchy.error[n]);
            put(std::bit_cast<float>(hierarchy.first[n]), std::bit_cast<float>(hierarchy.count[n]));
        }
        out.write(reinterpret_cast<const char*>(rows.data()),
                  static_cast<std::streamsize>(rows.size() * sizeof(float)));
    }
}

bool read_nodes(std::istream& in, std::size_t count, bool axis_aligned, Hierarchy& hierarchy) {
    Gaussians& nodes = hierarchy.nodes;
    nodes.mean.resize(count), nodes.scale.resize(count), nodes.density.resize(count);
    if (!axis_aligned) nodes.rotation.resize(count);
    hierarchy.first.resize(count), hierarchy.count.resize(count);
    hierarchy.radius.resize(count), hierarchy.error.resize(count);
    const std::size_t stride = words_per_node(axis_aligned);
    std::vector<float> rows(std::min(count, kBlock) * stride);
    for (std::size_t begin = 0; begin < count; begin += kBlock) {
        const std::size_t end = std::min(begin + kBlock, count);
        const std::size_t bytes = (end - begin) * stride * sizeof(float);
        if (!in.read(reinterpret_cast<char*>(rows.data()), static_cast<std::streamsize>(bytes)))
            return false;
        const float* row = rows.data();
        for (std::size_t n = begin; n < end; ++n, row += stride) {
            nodes.mean[n] = {row[0], row[1], row[2]};
            nodes.scale[n] = {row[3], row[4], row[5]};
            const float* rest = row + (axis_aligned ? 6 : 10);
            if (!axis_aligned) nodes.rotation[n] = {row[6], row[7], row[8], row[9]};
            nodes.density[n] = rest[0];
            hierarchy.radius[n] = rest[1];
            hierarchy.error[n] = rest[2];
            hierarchy.first[n] = std::bit_cast<std::uint32_t>(rest[3]);
            hierarchy.count[n] = std::bit_cast<std::uint32_t>(rest[4]);
        }
    }
    return true;
}

}  // namespace vog
