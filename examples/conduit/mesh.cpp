// mesh.cpp: coordinates, elements and values of Conduit's Blueprint as voxels and cells.
#include "mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <list>
#include <map>
#include <utility>

namespace conduit_mesh {
namespace {

using conduit::Node;
using vog::Error;
using vog::Vec3d;

constexpr const char* kAxes[] = {"x", "y", "z"};

/// One domain, and what its density lies on.
struct Domain {
    const Node& node;
    const Node& density;
    const Node& topology;
    const Node& coordinates;
    std::string type;  ///< of the coordinates: uniform, rectilinear, explicit

    bool at_vertices() const { return density["association"].as_string() == "vertex"; }
};

const Node& need(const Node& parent, const std::string& path, const std::string& what) {
    if (!parent.has_path(path)) throw Error("mesh: no " + what + " (" + path + ")");
    return parent[path];
}

std::vector<Domain> domains(const Node& mesh, const std::string& density) {
    std::vector<const Node*> nodes;
    if (mesh.has_child("topologies"))
        nodes.push_back(&mesh);
    else
        for (auto child = mesh.children(); child.has_next();) nodes.push_back(&child.next());
    std::vector<Domain> found;
    for (const Node* node : nodes) {
        const Node& field = need(*node, "fields/" + density, "field '" + density + "'");
        const Node& topology =
            need(*node, "topologies/" + field["topology"].as_string(), "topology");
        const Node& coordinates =
            need(*node, "coordsets/" + topology["coordset"].as_string(), "coordinates");
        found.push_back({*node, field, topology, coordinates, coordinates["type"].as_string()});
    }
    if (found.empty()) throw Error("mesh: no domain, expected topologies and coordsets");
    return found;
}

/// Marks of elements that belong to another domain; none: all count.
std::vector<char> ghosts(const Domain& domain) {
    for (const char* name : {"fields/ascent_ghosts/values", "fields/vtkGhostType/values"}) {
        if (!domain.node.has_path(name)) continue;
        const auto values = domain.node[name].as_float64_accessor();
        std::vector<char> marks(static_cast<std::size_t>(values.number_of_elements()));
        for (std::size_t n = 0; n < marks.size(); ++n)
            marks[n] = values[static_cast<conduit::index_t>(n)] != 0;
        return marks;
    }
    return {};
}

/// Elements of a lattice along x, y and z.
std::array<int, 3> elements_of(const Domain& domain) {
    std::array<int, 3> size{1, 1, 1};
    const auto axis = [&](const std::string& path, int k, auto count) {
        if (domain.node.has_path(path))
            size[static_cast<std::size_t>(k)] = count(domain.node[path]);
    };
    const std::string topology = "topologies/" + domain.density["topology"].as_string(),
                      coordinates = "coordsets/" + domain.topology["coordset"].as_string();
    for (int k = 0; k < 3; ++k) {
        const std::string ijk{"ijk"[k]};
        axis(topology + "/elements/dims/" + ijk, k, [](const Node& n) { return n.to_int(); });
        axis(coordinates + "/dims/" + ijk, k, [](const Node& n) { return n.to_int() - 1; });
        if (domain.type == "rectilinear")
            axis(coordinates + "/values/" + kAxes[k], k, [](const Node& n) {
                return static_cast<int>(n.dtype().number_of_elements()) - 1;
            });
    }
    return size;
}

Vec3d triple(const Node& parent, const char* name, std::array<const char*, 3> axes,
             double missing) {
    Vec3d found{missing, missing, missing};
    if (parent.has_child(name))
        for (int k = 0; k < 3; ++k)
            if (parent[name].has_child(axes[static_cast<std::size_t>(k)]))
                found[k] = parent[name][axes[static_cast<std::size_t>(k)]].to_float64();
    return found;
}
Vec3d spacing_of(const Domain& domain) {
    return triple(domain.coordinates, "spacing", {"dx", "dy", "dz"}, 1);
}
Vec3d origin_of(const Domain& domain) {
    return triple(domain.coordinates, "origin", {"x", "y", "z"}, 0);
}

/// Points of a domain, the lattice's with x fastest.
void add_points(const Domain& domain, vog::Cells& cells) {
    const Node& coordinates = domain.coordinates;
    if (domain.type == "explicit") {
        const Node& values = need(coordinates, "values", "coordinates");
        std::vector<conduit::float64_accessor> along;
        for (const char* axis : kAxes)
            if (values.has_child(axis)) along.push_back(values[axis].as_float64_accessor());
        for (conduit::index_t n = 0; n < along.front().number_of_elements(); ++n) {
            Vec3d point;
            for (std::size_t k = 0; k < along.size(); ++k) point[static_cast<int>(k)] = along[k][n];
            cells.points.push_back(point);
        }
        return;
    }
    const std::array<int, 3> size = elements_of(domain);
    const Vec3d origin = origin_of(domain), spacing = spacing_of(domain);
    const auto place = [&](int k, int n) {
        if (domain.type == "uniform") return origin[k] + n * spacing[k];
        return coordinates["values"][kAxes[k]].as_float64_accessor()[n];
    };
    for (int z = 0; z <= size[2]; ++z)
        for (int y = 0; y <= size[1]; ++y)
            for (int x = 0; x <= size[0]; ++x)
                cells.points.push_back({place(0, x), place(1, y), place(2, z)});
}

/// VTK's type of a shape of Blueprint, whose corners have VTK's order.
std::uint8_t type_of(const std::string& shape) {
    static const std::map<std::string, std::uint8_t> kTypes{
        {"tri", 5}, {"quad", 9}, {"tet", 10}, {"hex", 12}, {"wedge", 13}, {"pyramid", 14}};
    const auto found = kTypes.find(shape);
    if (found == kTypes.end())
        throw Error("mesh: elements '" + shape +
                    "', expected tet, hex, wedge, pyramid, tri or quad "
                    "(conduit::blueprint::mesh::generate_sides divides others)");
    return found->second;
}

/// Elements of a domain that are no ghosts. Their numbers go to `kept`.
void add_elements(const Domain& domain, std::uint32_t first_point, vog::Cells& cells,
                  std::vector<conduit::index_t>& kept) {
    const std::vector<char> marks = ghosts(domain);
    conduit::index_t number = 0;
    const auto add = [&](std::uint8_t type, auto corner) {
        const std::size_t n = static_cast<std::size_t>(number++);
        if (n < marks.size() && marks[n]) return;
        for (int k = 0; k < vog::corner_count(type); ++k)
            cells.corner.push_back(first_point + static_cast<std::uint32_t>(corner(k)));
        cells.type.push_back(type);
        cells.end.push_back(cells.corner.size());
        kept.push_back(number - 1);
    };
    const Node& topology = domain.topology;
    if (topology["type"].as_string() != "unstructured") {
        const std::array<int, 3> size = elements_of(domain);
        const int row = size[0] + 1, layer = row * (size[1] + 1);
        const int corners[] = {0, 1, row + 1, row, layer, layer + 1, layer + row + 1, layer + row};
        for (int z = 0; z < size[2]; ++z)
            for (int y = 0; y < size[1]; ++y)
                for (int x = 0; x < size[0]; ++x)
                    add(12, [&](int k) { return z * layer + y * row + x + corners[k]; });
        return;
    }
    const Node& elements = need(topology, "elements", "elements");
    const auto connectivity = elements["connectivity"].as_int64_accessor();
    const std::string shape = elements["shape"].as_string();
    conduit::index_t at = 0;
    if (shape != "mixed") {
        const std::uint8_t type = type_of(shape);
        for (; at < connectivity.number_of_elements(); at += vog::corner_count(type))
            add(type, [&](int k) { return connectivity[at + k]; });
        return;
    }
    std::map<std::int64_t, std::uint8_t> types;
    for (auto entry = elements["shape_map"].children(); entry.has_next();) {
        const Node& code = entry.next();
        types[code.to_int64()] = type_of(entry.name());
    }
    const auto shapes = elements["shapes"].as_int64_accessor();
    for (conduit::index_t n = 0; n < shapes.number_of_elements(); ++n) {
        const std::uint8_t type = types.at(shapes[n]);
        const conduit::index_t from =
            elements.has_child("offsets") ? elements["offsets"].as_int64_accessor()[n] : at;
        add(type, [&](int k) { return connectivity[from + k]; });
        at += vog::corner_count(type);
    }
}

/// Adds a field's values of the points, or of the kept elements.
void add_values(const Domain& domain, const std::string& name, vog::CellValues& values,
                const std::vector<conduit::index_t>& kept, bool is_first) {
    const Node& field = need(domain.node, "fields/" + name, "field '" + name + "'");
    const bool at_points = field["association"].as_string() == "vertex";
    const Node& data = field["values"];
    const auto parts = data.number_of_children();
    if (is_first) {
        values.name = name;
        if (field.has_child("units")) values.unit = field["units"].as_string();
        values.at_points = at_points;
        values.component.resize(parts > 0 ? static_cast<std::size_t>(parts) : 1);
    }
    if (values.at_points != at_points)
        throw Error("mesh: field '" + name +
                    "' is of elements in one domain and of vertices in another");
    for (std::size_t k = 0; k < values.component.size(); ++k) {
        const auto from =
            (parts > 0 ? data[static_cast<conduit::index_t>(k)] : data).as_float64_accessor();
        auto& to = values.component[k];
        const auto put = [&](conduit::index_t n) { to.push_back(static_cast<float>(from[n])); };
        if (at_points)
            for (conduit::index_t n = 0; n < from.number_of_elements(); ++n) put(n);
        else
            std::ranges::for_each(kept, put);
    }
}

bool are_voxels(const std::vector<Domain>& all) {
    return std::ranges::all_of(
        all, [](const Domain& d) { return d.type == "uniform" && !d.at_vertices(); });
}

}  // namespace

vog::Levels levels_of(const Node& mesh, const std::string& density) {
    struct Level {
        Vec3d origin, spacing;
        std::vector<vog::DenseBlock> blocks;
    };
    std::vector<Level> levels;
    std::list<std::vector<float>> copies;
    std::list<std::vector<std::uint8_t>> masks;
    for (const Domain& domain : domains(mesh, density)) {
        const Vec3d spacing = spacing_of(domain), origin = origin_of(domain);
        auto level = std::ranges::find_if(levels, [&](const Level& l) {
            return length(l.spacing - spacing) < 1e-9 * length(spacing);
        });
        if (level == levels.end()) level = levels.insert(level, Level{origin, spacing, {}});
        const auto [nx, ny, nz] = elements_of(domain);
        vog::DenseBlock block{.size = {nx, ny, nz}};
        for (int k = 0; k < 3; ++k)
            block.first[k] =
                static_cast<int>(std::lround((origin[k] - level->origin[k]) / spacing[k]));

        // The solver's own array where it has floats, however far apart.
        const Node& values = domain.density["values"];
        std::ptrdiff_t step = 1;
        if (values.dtype().is_float32() && values.dtype().stride() % 4 == 0) {
            block.value = static_cast<const float*>(values.element_ptr(0));
            step = values.dtype().stride() / 4;
        } else {
            const auto from = values.as_float64_accessor();
            std::vector<float>& copy = copies.emplace_back();
            for (conduit::index_t n = 0; n < from.number_of_elements(); ++n)
                copy.push_back(static_cast<float>(from[n]));
            block.value = copy.data();
        }
        block.stride = {step, step * nx, step * nx * ny};
        if (const std::vector<char> marks = ghosts(domain); !marks.empty()) {
            std::vector<std::uint8_t>& mask = masks.emplace_back(marks.size());
            for (std::size_t n = 0; n < marks.size(); ++n)
                mask[n] = !marks[n] && block.value[static_cast<std::ptrdiff_t>(n) * step] > 0;
            block.active = mask.data();
            block.active_stride = {1, nx, std::ptrdiff_t{nx} * ny};
        }
        level->blocks.push_back(block);
    }
    vog::Levels found;
    for (const Level& level : levels)
        found.volumes.push_back(volume_from_dense(
            level.blocks,
            vog::affine_from_voxels(level.spacing, level.origin + 0.5 * level.spacing), density));
    return found;
}

vog::Cells cells_of(const Node& mesh, const std::string& density,
                    std::span<const std::string> fields) {
    const std::vector<Domain> all = domains(mesh, density);
    for (const Domain& domain : all)
        if (domain.type == "uniform" && length(spacing_of(domain) - spacing_of(all.front())) >
                                            1e-9 * length(spacing_of(domain)))
            throw Error(
                "mesh: levels of several spacings with further fields, or with values at vertices; "
                "expected one "
                "level, or the density of elements alone");
    vog::Cells cells;
    cells.source = "mesh";
    cells.fields.resize(fields.size());
    for (const Domain& domain : all) {
        const bool is_first = &domain == &all.front();
        const auto first_point = static_cast<std::uint32_t>(cells.points.size());
        std::vector<conduit::index_t> kept;
        add_points(domain, cells);
        add_elements(domain, first_point, cells, kept);
        add_values(domain, density, cells.density, kept, is_first);
        for (std::size_t n = 0; n < fields.size(); ++n)
            add_values(domain, fields[n], cells.fields[n], kept, is_first);
    }
    validate(cells);
    return cells;
}

vog::Gaussians convert(const Node& mesh, const std::string& density,
                       std::span<const std::string> fields, std::size_t budget) {
    if (!fields.empty() || !are_voxels(domains(mesh, density)))
        return convert_cells(cells_of(mesh, density, fields), {.budget = budget});
    const vog::Levels levels = levels_of(mesh, density);
    if (levels.volumes.size() == 1)
        return convert_moments(levels.volumes.front(), {.budget = budget, .own_field = density});
    return convert_moments(composite(levels), {.budget = budget});
}

}  // namespace conduit_mesh
