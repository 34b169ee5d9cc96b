// ply_nodes.cpp: rows of the PLY element `node`, in blocks of 65536.
#include "io/ply/ply_nodes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <istream>
#include <ostream>

#include "data/fields/field_arrays.h"
#include "vog/distributed.h"

namespace vog::ply {

namespace {

constexpr std::size_t kBlock = 1 << 16;

}  // namespace

std::vector<std::string> gaussian_properties(bool rotated, const Fields& fields) {
    std::vector<std::string> names{"x", "y", "z", "scale_0", "scale_1", "scale_2"};
    if (rotated) names.insert(names.end(), {"rot_0", "rot_1", "rot_2", "rot_3"});
    names.emplace_back("density");
    for (std::string& name : column_names(fields)) names.push_back(std::move(name));
    return names;
}

std::vector<std::string> node_properties(bool axis_aligned, const Fields& fields) {
    std::vector<std::string> names = gaussian_properties(!axis_aligned, fields);
    for (std::string& name : names) name.insert(0, "float ");
    for (const char* name : {"float radius", "float error", "uchar nodes", "uchar vertices"})
        names.emplace_back(name);
    return names;
}

std::size_t bytes_per_node(bool axis_aligned, const Fields& fields) {
    constexpr std::size_t kRadiusAndError = 2, kCounts = 2;
    return (ply_row_floats(!axis_aligned, fields) + kRadiusAndError) * sizeof(float) + kCounts;
}

std::string node_header(const Hierarchy& hierarchy) {
    if (hierarchy.empty()) return {};
    std::string text = fmt::format("element node {}\n", hierarchy.size());
    for (const std::string& name :
         node_properties(hierarchy.nodes.axis_aligned(), hierarchy.nodes.fields))
        text += "property " + name + "\n";
    return text;
}

void write_nodes(std::ostream& out, const Hierarchy& hierarchy) {
    const Gaussians& nodes = hierarchy.nodes;
    std::vector<char> rows(std::min(hierarchy.size(), kBlock) *
                           bytes_per_node(nodes.axis_aligned(), nodes.fields));
    const auto columns = columns_of(nodes.fields);
    for (std::size_t begin = 0; begin < hierarchy.size(); begin += kBlock) {
        const std::size_t end = std::min(begin + kBlock, hierarchy.size());
        char* at = rows.data();
        const auto put = [&at](auto... values) {
            ((std::memcpy(at, &values, sizeof(values)), at += sizeof(values)), ...);
        };
        for (std::size_t n = begin; n < end; ++n) {
            put(nodes.mean[n].x, nodes.mean[n].y, nodes.mean[n].z);
            put(nodes.scale[n].x, nodes.scale[n].y, nodes.scale[n].z);
            if (!nodes.axis_aligned()) {
                const Quat q = nodes.rotation[n];
                put(q.w, q.x, q.y, q.z);
            }
            put(nodes.density[n]);
            for (const auto& column : columns) put(column[n]);
            put(hierarchy.radius[n], hierarchy.error[n]);
            put(hierarchy.node_count[n], hierarchy.leaf_count[n]);
        }
        out.write(rows.data(), at - rows.data());
    }
}

bool read_nodes(std::istream& in, std::size_t count, bool axis_aligned, const Fields& fields,
                Hierarchy& hierarchy) {
    Gaussians& nodes = hierarchy.nodes;
    nodes.mean.resize(count), nodes.scale.resize(count), nodes.density.resize(count);
    if (!axis_aligned) nodes.rotation.resize(count);
    hierarchy.node_count.resize(count), hierarchy.leaf_count.resize(count);
    hierarchy.radius.resize(count), hierarchy.error.resize(count);
    nodes.fields = empty_fields(fields);
    each_array([&](auto& array) { array.resize(count); }, nodes.fields);
    const auto columns = columns_of(nodes.fields);
    const std::size_t row_bytes = bytes_per_node(axis_aligned, fields);
    std::vector<char> rows(std::min(count, kBlock) * row_bytes);
    for (std::size_t begin = 0; begin < count; begin += kBlock) {
        const std::size_t end = std::min(begin + kBlock, count);
        if (!in.read(rows.data(), static_cast<std::streamsize>((end - begin) * row_bytes)))
            return false;
        const char* at = rows.data();
        const auto take = [&at](auto&... values) {
            ((std::memcpy(&values, at, sizeof(values)), at += sizeof(values)), ...);
        };
        for (std::size_t n = begin; n < end; ++n) {
            take(nodes.mean[n].x, nodes.mean[n].y, nodes.mean[n].z);
            take(nodes.scale[n].x, nodes.scale[n].y, nodes.scale[n].z);
            if (!axis_aligned) {
                Quat& q = nodes.rotation[n];
                take(q.w, q.x, q.y, q.z);
            }
            take(nodes.density[n]);
            for (const auto& column : columns) take(column[n]);
            take(hierarchy.radius[n], hierarchy.error[n]);
            take(hierarchy.node_count[n], hierarchy.leaf_count[n]);
        }
    }
    return true;
}

}  // namespace vog::ply
