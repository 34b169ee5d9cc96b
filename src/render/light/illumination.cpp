// illumination.cpp: Marches an extinction lattice towards lights.
#include "render/light/illumination.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/parallel.h"
#include "vog/distributed.h"

namespace vog::lights {

namespace {

/// Cells along the longest edge of the data.
constexpr int kModelCells = 64, kVoxelCells = 128;

/// Layers of cells across the axis that a direction is longest along, with an empty cell around each layer.
struct Layers {
    int axis, along_row, along_column;  ///< of the lattice
    int count, rows, columns;           ///< of a layer: with its empty cells
    std::vector<float> value;

    Layers(const ExtinctionLattice& of, int longest)
        : axis(longest),
          along_row(longest == 0 ? 1 : 0),
          along_column(longest == 2 ? 1 : 2),
          count(of.size[axis]),
          rows(of.size[along_column] + 2),
          columns(of.size[along_row] + 2) {
        value.resize(size() * static_cast<std::size_t>(count));
        for (int n = 0; n < count; ++n)
            for_each_cell(n, of, [&](std::size_t in_layer, std::size_t cell) {
                layer(n)[in_layer] = static_cast<float>(of.sum[cell]);
            });
    }
    std::size_t size() const {
        return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
    }
    float* layer(int n) { return value.data() + static_cast<std::size_t>(n) * size(); }
    const float* layer(int n) const { return value.data() + static_cast<std::size_t>(n) * size(); }
    /// Calls visit(place in the layer, cell of the lattice).
    template <class Visit>
    void for_each_cell(int n, const ExtinctionLattice& of, const Visit& visit) const {
        for (int row = 1; row + 1 < rows; ++row)
            for (int column = 1; column + 1 < columns; ++column) {
                Vec3i cell;
                cell[axis] = n, cell[along_row] = column - 1, cell[along_column] = row - 1;
                visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) +
                          static_cast<std::size_t>(column),
                      of.at(cell.x, cell.y, cell.z));
            }
    }
};

/// A layer moved by cells and parts of cells, between which it is linear.
class Shift {
  public:
    Shift(const Layers& layers, double along_row, double along_column)
        : rows_(layers.rows), columns_(layers.columns) {
        const double down = std::floor(along_column), right = std::floor(along_row);
        down_ = static_cast<int>(down), right_ = static_cast<int>(right);
        v_ = static_cast<float>(along_column - down), u_ = static_cast<float>(along_row - right);
    }
    void add(const float* from, float factor, float* to) const {
        const float upper[2] = {factor * (1 - v_) * (1 - u_), factor * (1 - v_) * u_};
        const float lower[2] = {factor * v_ * (1 - u_), factor * v_ * u_};
        const int first = std::max(0, -right_), last = std::min(columns_, columns_ - 1 - right_);
        for (int row = std::max(0, -down_); row < std::min(rows_, rows_ - 1 - down_); ++row) {
            const float* above =
                from + static_cast<std::ptrdiff_t>(row + down_) * columns_ + right_;
            const float* below = above + columns_;
            float* sums = to + static_cast<std::ptrdiff_t>(row) * columns_;
            for (int n = first; n < last; ++n)
                sums[n] += upper[0] * above[n] + upper[1] * above[n + 1] + lower[0] * below[n] +
                           lower[1] * below[n + 1];
        }
    }

  private:
    int rows_, columns_, down_, right_;
    float u_, v_;
};

/// Directions all over a sphere, as evenly as Fibonacci's spiral has them.
std::vector<Vec3d> all_directions(int count) {
    std::vector<Vec3d> all;
    for (int n = 0; n < count; ++n) {
        const double z = 1 - (2 * n + 1.0) / count, across = std::sqrt(1 - z * z);
        const double angle = 2 * std::numbers::pi * n / std::numbers::phi;
        all.push_back({across * std::cos(angle), across * std::sin(angle), z});
    }
    return all;
}

}  // namespace

std::vector<float> depths_towards(const ExtinctionLattice& extinction, Vec3d towards) {
    int axis = 0;
    for (int n = 1; n < 3; ++n)
        if (std::abs(towards[n]) > std::abs(towards[axis])) axis = n;
    const double longest = std::abs(towards[axis]);
    const int forward = towards[axis] > 0 ? 1 : -1;
    const Layers layers(extinction, axis);
    const double row_step = towards[layers.along_row] / longest,
                 column_step = towards[layers.along_column] / longest;
    const auto step = static_cast<float>(extinction.edge * length(towards) / longest);
    std::vector<float> depths(extinction.sum.size());
    vog::parallel_for(0, layers.count, [&](int n) {
        std::vector<float> sums(layers.size());
        for (int k = 0; n + k * forward >= 0 && n + k * forward < layers.count; ++k)
            Shift(layers, k * row_step, k * column_step)
                .add(layers.layer(n + k * forward), k == 0 ? 0.5f * step : step, sums.data());
        layers.for_each_cell(n, extinction, [&](std::size_t in_layer, std::size_t cell) {
            depths[cell] = sums[in_layer];
        });
    });
    return depths;
}

namespace {

/// Share of opaque matter in a cell or one beside it, steep: 0 of an optical depth below 1 over a model's cell, 1 above 16. In matter that
/// is less dense, light that is read elsewhere is too bright (docs/volume_rendering.md, "Beside a path tracer"). None where no cell
/// has a hundredth.
std::vector<float> opaque_cells(const ExtinctionLattice& extinction) {
    constexpr double kHalf = 4;
    std::vector<double> most = extinction.whole.empty() ? extinction.sum : extinction.whole, before;
    // The largest of three along each axis in turn.
    std::size_t stride = 1;
    for (int axis = 0; axis < 3; ++axis) {
        before = most;
        const auto count = static_cast<std::size_t>(extinction.size[axis]);
        for (std::size_t n = 0; n < most.size(); ++n) {
            const std::size_t place = n / stride % count;
            if (place > 0) most[n] = std::max(most[n], before[n - stride]);
            if (place + 1 < count) most[n] = std::max(most[n], before[n + stride]);
        }
        stride *= count;
    }
    std::vector<float> opaque(most.size());
    for (std::size_t n = 0; n < most.size(); ++n) {
        const double depth = most[n] * extinction.edge * extinction.cells / kModelCells;
        opaque[n] = static_cast<float>(1 / (1 + std::pow(kHalf / std::max(depth, 1e-30), 4)));
    }
    if (std::ranges::max(opaque) < 0.01f) opaque.clear();
    return opaque;
}

}  // namespace

Illumination::Illumination(const ExtinctionLattice& extinction)
    : opaque_(opaque_cells(extinction)),
      surfaces_(extinction.surfaces),
      first_(extinction.first),
      edge_(extinction.edge),
      size_(extinction.size),
      shift_(double(extinction.cells) / kModelCells) {}

void Illumination::set_direct(const ExtinctionLattice& extinction, std::span<const Vec3d> towards,
                              int octaves) {
    const std::size_t cells = extinction.sum.size();
    direct_.resize(cells * towards.size());
    for (std::size_t light = 0; light < towards.size(); ++light) {
        if (light < towards_.size() && towards_[light] == towards[light] && octaves == octaves_)
            continue;
        // Wrenninge's octaves: light scattered again and again passes through more.
        const std::vector<float> depths = depths_towards(extinction, towards[light]);
        const std::span<float> shares(direct_.data() + light * cells, cells);
        std::ranges::fill(shares, 0.0f);
        float whole = 0;
        for (int octave = 0; octave < octaves; ++octave) {
            const float part = std::exp2(static_cast<float>(-octave));
            whole += part;
            for (std::size_t n = 0; n < cells; ++n) shares[n] += part * std::exp(-part * depths[n]);
        }
        for (float& share : shares) share /= whole;
    }
    towards_.assign(towards.begin(), towards.end());
    octaves_ = octaves;
}

void Illumination::set_ambient(const ExtinctionLattice& extinction) {
    constexpr int kDirections = 24;
    ambient_.assign(extinction.sum.size(), 0);
    for (const Vec3d& direction : all_directions(kDirections)) {
        const std::vector<float> depths = depths_towards(extinction, direction);
        for (std::size_t n = 0; n < depths.size(); ++n)
            ambient_[n] += std::exp(-depths[n]) / kDirections;
    }
}

namespace {

bool is_absorbed(const VolumeLook& look) { return look.shadows || look.occlusion; }

/// What cuts the matter that absorbs light.
Clipping clip_of(const VolumeLook& look) { return look.clip_lights ? look.clip : Clipping{}; }

ExtinctionLattice extinction_of(const LitModel& model, const VolumeLook& look) {
    ExtinctionLattice lattice(view_box(model.gaussians), kModelCells);
    add_extinction(model.gaussians, model.field, model.light, model.unit, model.processes, lattice);
    lattice.clip(clip_of(look));
    return lattice;
}

Illumination illumination(const ExtinctionLattice& extinction, const VolumeLook& look,
                          Vec3d forward) {
    Illumination light(extinction);
    light.set_shaded(look.light);
    if (look.shadows) light.set_direct(extinction, directions_of(look, forward), look.octaves);
    if (look.occlusion) light.set_ambient(extinction);
    return light;
}

}  // namespace

std::vector<Vec3d> directions_of(const VolumeLook& look, Vec3d forward) {
    std::vector<Vec3d> towards;
    if (look.shadows)
        for (const DirectionalLight& light : lights_of(look))
            towards.push_back(light.towards == Vec3d{} ? -forward : light.towards);
    return towards;
}

Illumination illumination(const LitModel& model, const VolumeLook& look, Vec3d forward) {
    if (!is_absorbed(look)) return {};
    return illumination(extinction_of(model, look), look, forward);
}

bool KeptIllumination::update(int version, const LitModel& model, const VolumeLook& look,
                              Vec3d forward) {
    bool changes = false;
    if (version != version_ || !(clip_of(look) == clip_of(look_))) {
        changes = extinction_.has_value();
        *this = {};
        version_ = version;
    }
    if (is_absorbed(look) && !extinction_) {
        extinction_ = extinction_of(model, look);
        light_ = Illumination(*extinction_);
    }
    std::vector<Vec3d> towards = directions_of(look, forward);
    if (towards != towards_ || (look.shadows && look.octaves != look_.octaves)) {
        if (look.shadows)
            light_.set_direct(*extinction_, towards, look.octaves);
        else
            light_.clear_direct();
        changes = true;
    }
    if (look.occlusion != look_.occlusion) {
        light_.clear_ambient();
        if (look.occlusion) light_.set_ambient(*extinction_);
        changes = true;
    }
    light_.set_shaded(look.light);
    look_ = look, towards_ = std::move(towards);
    return changes;
}

Illumination illumination(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                          const ValueTransfer& transfer, const VolumeLook& look, Vec3d forward,
                          const Collective* processes) {
    if (!is_absorbed(look)) return {};
    Box box;
    for (const Volume& volume : volumes) box.include(world_box(volume));
    const auto add = [&](ExtinctionLattice& lattice) {
        for (std::size_t n = 0; n < volumes.size(); ++n)
            add_extinction(volumes[n], fields[n], transfer, lattice);
        if (processes) processes->sum(lattice.sum);
    };
    return illumination(box, true, add, look, forward, processes);
}

Illumination illumination(Box box, bool of_voxels,
                          const std::function<void(ExtinctionLattice&)>& add,
                          const VolumeLook& look, Vec3d forward, const Collective* processes) {
    if (!is_absorbed(look)) return {};
    if (processes) {
        double faces[6] = {-box.lower.x, -box.lower.y, -box.lower.z,
                           box.upper.x,  box.upper.y,  box.upper.z};
        processes->max(faces);
        box = {{-faces[0], -faces[1], -faces[2]}, {faces[3], faces[4], faces[5]}};
    }
    ExtinctionLattice lattice(box, of_voxels ? kVoxelCells : kModelCells);
    add(lattice);
    lattice.clip(clip_of(look));
    return illumination(lattice, look, forward);
}

device::LightLattice Illumination::lattice(Vec3d origin, double unit) const {
    const Vec3d first = (1 / unit) * (first_ - origin);
    device::LightLattice out{direct_.empty() ? nullptr : direct_.data(),
                             ambient_.empty() ? nullptr : ambient_.data(),
                             opaque_.empty() ? nullptr : opaque_.data(),
                             {size_.x, size_.y, size_.z},
                             {first.x, first.y, first.z},
                             unit / edge_,
                             {},
                             {},
                             shift_,
                             0};
    // Octaves pass through more: 1 / (1 + inside) is the mean of theirs.
    double whole = 0, left = 0;
    for (int octave = 0; octave < octaves_; ++octave) {
        const double part = std::exp2(-octave);
        whole += part, left += part / (1 + part * device::LightLattice::kInside);
    }
    if (!surfaces_ && !shaded_) out.inside = whole / left - 1;
    for (std::size_t n = 0; n < towards_.size(); ++n) {
        const Vec3d to = normalized(towards_[n]);
        out.towards[n] = {to.x, to.y, to.z};
        out.middle = out.middle + (1.0 / static_cast<double>(towards_.size())) * out.towards[n];
    }
    return out;
}

}  // namespace vog::lights
