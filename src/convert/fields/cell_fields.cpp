// cell_fields.cpp: samples of each cell side by side, then its plane and residuals.
#include "convert/fields/cell_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "convert/moments/cells/leaf_cells.h"
#include "convert/moments/cells/overlapping_cells.h"
#include "core/parallel.h"

namespace vog::joint {

namespace {

using moments::Brick;
using moments::MomentSums;
using moments::MortonNode;

/// Samples are added up in as many lanes, which compilers make vectors of.
constexpr std::size_t kLanes = 16;
using Lanes = std::array<float, kLanes>;

double sum_of(const Lanes& lanes) {
    return std::accumulate(lanes.begin(), lanes.end(), 0.0,
                           [](double sum, float lane) { return sum + double{lane}; });
}

/// Cube of samples about its centre: places in samples, filled up to whole lanes with samples of weight 0.
struct SampleCube {
    std::size_t count = 0;
    std::vector<float> x, y, z, weight;

    /// weight  [edge] of a sample along each axis
    explicit SampleCube(std::span<const float> weights) {
        const std::size_t edge = weights.size();
        count = (edge * edge * edge + kLanes - 1) / kLanes * kLanes;
        for (std::vector<float>* all : {&x, &y, &z, &weight}) all->assign(count, 0);
        const float middle = 0.5f * static_cast<float>(edge - 1);
        for (std::size_t n = 0; n < edge * edge * edge; ++n) {
            const std::array<std::size_t, 3> at{n / (edge * edge), n / edge % edge, n % edge};
            x[n] = static_cast<float>(at[0]) - middle;
            y[n] = static_cast<float>(at[1]) - middle;
            z[n] = static_cast<float>(at[2]) - middle;
            weight[n] = weights[at[0]] * weights[at[1]] * weights[at[2]];
        }
    }
};

/// A cube of samples with its values; lengths in voxels.
struct Samples {
    const SampleCube* cube = nullptr;
    const float* mass = nullptr;  ///< [count] up to a factor, the same for all samples of a cell
    const std::vector<std::vector<float>>* value = nullptr;  ///< [components][count]
    Vec3d offset;        ///< of the cube's centre from the cell's
    double spacing = 1;  ///< of samples
};

/// Sums of a cell about its centre: mass, and of one component the value and the value times position.
struct ValueSums {
    double mass = 0, value = 0;
    Vec3d along;
};

void add_values(const Samples& samples, std::size_t component, ValueSums& sums) {
    const SampleCube& cube = *samples.cube;
    const float *m = samples.mass, *phi = (*samples.value)[component].data();
    const float *x = cube.x.data(), *y = cube.y.data(), *z = cube.z.data();
    Lanes mass{}, value{}, px{}, py{}, pz{};
    for (std::size_t first = 0; first < cube.count; first += kLanes)
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t n = first + lane;
            const float part = m[n] * phi[n];
            mass[lane] += m[n], value[lane] += part;
            px[lane] += part * x[n], py[lane] += part * y[n], pz[lane] += part * z[n];
        }
    const double total = sum_of(value);
    sums.mass += sum_of(mass), sums.value += total;
    sums.along = sums.along + total * samples.offset +
                 samples.spacing * Vec3d{sum_of(px), sum_of(py), sum_of(pz)};
}

/// A plane at samples: base + x x + y y + z z.
struct SamplePlane {
    float base, x, y, z;
    /// value, gradient  at the cell's centre, per voxel
    SamplePlane(double value, Vec3d gradient, const Samples& samples)
        : base(static_cast<float>(value + dot(gradient, samples.offset))),
          x(static_cast<float>(samples.spacing * gradient.x)),
          y(static_cast<float>(samples.spacing * gradient.y)),
          z(static_cast<float>(samples.spacing * gradient.z)) {}
    float operator()(const SampleCube& cube, std::size_t n) const {
        return base + x * cube.x[n] + y * cube.y[n] + z * cube.z[n];
    }
};

void add_scalar_residuals(const Samples& samples, std::size_t component, const SamplePlane& plane,
                          double* to) {
    const SampleCube& cube = *samples.cube;
    const float *m = samples.mass, *phi = (*samples.value)[component].data();
    Lanes square{}, third{};
    for (std::size_t first = 0; first < cube.count; first += kLanes)
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t n = first + lane;
            const float z = phi[n] - plane(cube, n), part = m[n] * z * z;
            square[lane] += part, third[lane] += part * z;
        }
    to[0] += sum_of(square), to[1] += sum_of(third);
}

void add_vector_residuals(const Samples& samples, std::size_t component, const SamplePlane* planes,
                          double* to) {
    const SampleCube& cube = *samples.cube;
    const float* m = samples.mass;
    std::array<const float*, 3> phi;
    for (std::size_t c = 0; c < 3; ++c) phi[c] = (*samples.value)[component + c].data();
    std::array<Lanes, kVectorSums> sums{};
    for (std::size_t first = 0; first < cube.count; first += kLanes)
        for (std::size_t lane = 0; lane < kLanes; ++lane) {
            const std::size_t n = first + lane;
            const float x = phi[0][n] - planes[0](cube, n), y = phi[1][n] - planes[1](cube, n);
            const float z = phi[2][n] - planes[2](cube, n);
            const float mx = m[n] * x, my = m[n] * y;
            sums[0][lane] += mx * x, sums[1][lane] += mx * y, sums[2][lane] += mx * z;
            sums[3][lane] += my * y, sums[4][lane] += my * z, sums[5][lane] += m[n] * z * z;
        }
    for (std::size_t s = 0; s < kVectorSums; ++s) to[s] += sum_of(sums[s]);
}

/// Planes and residuals of consecutive cells.
struct CellFields {
    std::vector<WorldPlane> planes;  ///< [cells][components]
    std::vector<double> residuals;   ///< [cells][Layout::residual_sums], of mass 1
    std::size_t count = 0;
};

/// Value of a sample in the component's unit, as BrickValues::load.
float in_units(const Component& component, float value) {
    return 1 / component.unit * (value - component.reference);
}
bool is_own(const Component& component) {
    return component.values->leaf.empty() && component.values->tile.empty();
}
float tile_value(const Component& component, std::size_t tile) {
    return in_units(component, is_own(component) ? component.volume->tiles[tile].value
                                                 : component.values->tile[tile]);
}

/// Two factors that together bring a mass near 1: one alone may leave the range of floats.
struct MassScale {
    float first, second;
    explicit MassScale(double mass) {
        const int exponent = -std::ilogb(mass), half = exponent / 2;
        first = std::ldexp(1.0f, half), second = std::ldexp(1.0f, exponent - half);
    }
    float operator()(float mass) const { return first * mass * second; }
};

/// Sums of the fields of single cells.
class CellSums {
  public:
    struct Scratch {
        moments::OverlapScratch windows;
        std::vector<std::vector<float>> around;  ///< [components] as windows.values
        std::vector<float> mass;
        std::vector<std::vector<float>> value;  ///< [components][samples]
    };

    CellSums(const Volume& volume, std::span<const Component> components, const Layout& layout,
             int block_voxels, bool overlapping)
        : volume_(volume),
          components_(components),
          layout_(layout),
          block_(block_voxels),
          overlapping_(overlapping && block_voxels > 1),  // one voxel has no window
          to_world_(transpose(inverse(volume.world_from_index).linear)),
          cube_(weights()) {}
    Scratch scratch() const {
        Scratch scratch;
        scratch.value.assign(components_.size(), std::vector<float>(cube_.count));
        scratch.mass.resize(cube_.count);
        scratch.around.resize(components_.size());
        return scratch;
    }
    /// Appends the fields of a cell of at most a leaf's edge.
    /// cell  of overlapping ones with the windows of its node; scratch.around has the other components
    void take_cell(const moments::CutCell& cell, Scratch& scratch, CellFields& to) const;

  protected:
    /// Weights of samples along an axis of a cell.
    std::vector<float> weights() const {
        if (!overlapping_)
            return std::vector<float>(static_cast<std::size_t>(std::min(block_, kLeafEdge)), 1);
        constexpr auto kOuter = static_cast<float>(moments::kOuterWeight);
        const auto half = static_cast<std::size_t>(block_ / 2);
        std::vector<float> all(4 * half, 1 - kOuter);
        std::fill_n(all.begin(), half, kOuter);
        std::fill_n(all.end() - static_cast<std::ptrdiff_t>(half), half, kOuter);
        return all;
    }
    /// Sets the samples of a cell of a leaf, or of a window about one.
    /// place  of the cell among the node's
    void fill_hard(const MortonNode& node, Vec3i place, const MassScale& scale,
                   Scratch& scratch) const;
    void fill_window(const moments::OverlapScratch& windows, Vec3i place, const MassScale& scale,
                     Scratch& scratch) const;
    template <int edge>
    void fill_window_of(const moments::OverlapScratch& windows, Vec3i place, const MassScale& scale,
                        Scratch& scratch) const;
    /// Appends a cell without variation.
    void add_constant(std::size_t tile, CellFields& to) const {
        for (const Component& component : components_)
            to.planes.push_back({double{tile_value(component, tile)}, {}});
        to.residuals.insert(to.residuals.end(), layout_.residual_sums, 0);
        ++to.count;
    }
    /// Appends the planes of all components and their residuals.
    /// sums         of the cell about its centre
    /// for_samples  calls its argument with each of the cell's Samples
    template <class ForSamples>
    void add_cell(const MomentSums& sums, const ForSamples& for_samples, CellFields& to) const;

    const Volume& volume_;
    std::span<const Component> components_;
    const Layout& layout_;
    int block_;
    bool overlapping_;
    Mat3 to_world_;  ///< of gradients
    SampleCube cube_;
};

/// Cells of a volume with their fields.
class CutCells : CellSums {
  public:
    CutCells(const Volume& volume, std::span<const Component> components, const Layout& layout,
             const CutModel& model)
        : CellSums(volume, components, layout, model.cells.block_voxels, model.cells.overlapping),
          cut_(model.cells),
          nodes_(moments::morton_nodes(volume)) {
        if (overlapping_)
            windows_.emplace(volume, nodes_, cut_.block_voxels,
                             moments::leaf_period(model.period, volume.world_from_index));
        // Nodes of one cell stay together.
        for (std::size_t n = 0; n < nodes_.size(); ++n)
            if (tasks_.empty() || (n - tasks_.back() >= moments::kNodeChunk && begins_cell(n)))
                tasks_.push_back(n);
        tasks_.push_back(nodes_.size());
    }
    std::size_t task_count() const { return tasks_.size() - 1; }
    /// The kept cells of one task.
    void take(std::size_t task, CellFields& to) const {
        Scratch buffers = scratch();
        for (std::size_t n = tasks_[task]; n < tasks_[task + 1];)
            if (cut_.block_voxels > kLeafEdge) {
                std::size_t end = n + 1;
                while (end < tasks_[task + 1] && !begins_cell(end)) ++end;
                take_large_cell(n, end, buffers, to);
                n = end;
            } else {
                take_node(nodes_[n++], buffers, to);
            }
    }

  private:
    /// Whether a node begins a cell above a leaf's edge.
    bool begins_cell(std::size_t n) const {
        return n == 0 || !(cell_of(nodes_[n]) == cell_of(nodes_[n - 1]));
    }
    /// Least voxel of such a cell.
    Vec3i cell_of(const MortonNode& node) const {
        const int edge = cell_edge(node);
        const auto down = [&](int at) { return at - ((at % edge) + edge) % edge; };
        return {down(node.origin.x), down(node.origin.y), down(node.origin.z)};
    }
    int cell_edge(const MortonNode& node) const { return std::max(cut_.block_voxels, node.edge); }

    /// Whether the conversion kept a cell: its histogram is of floats.
    bool is_kept(double mass) const {
        const auto rounded = static_cast<float>(mass);
        return (std::isnormal(rounded) ? double{rounded} : mass) >= cut_.least_mass;
    }
    void take_node(const MortonNode& node, Scratch& scratch, CellFields& to) const;
    void take_large_cell(std::size_t first, std::size_t last, Scratch& scratch,
                         CellFields& to) const;
    void fill_brick(const Brick& brick, const MortonNode& node, const MassScale& scale,
                    Scratch& scratch) const;

    const UniformCells& cut_;
    std::vector<MortonNode> nodes_;
    std::optional<moments::OverlappingCells> windows_;
    std::vector<std::size_t> tasks_;  ///< first nodes
};

template <class ForSamples>
void CellSums::add_cell(const MomentSums& sums, const ForSamples& for_samples,
                        CellFields& to) const {
    const moments::Moments cell = moments::moments_of(sums);
    std::array<double, 3> value{};
    std::array<Vec3d, 3> gradient;
    for (std::size_t part = 0, c = 0; part < layout_.parts.size(); ++part) {
        ValueSums of;
        for_samples([&](const Samples& samples) { add_values(samples, part, of); });
        value[c] = of.value / of.mass;
        gradient[c] =
            least_squares(cell.covariance, (1 / of.mass) * of.along - value[c] * cell.mean);
        to.planes.push_back({value[c], to_world_ * gradient[c]});
        const bool last = part + 1 == layout_.parts.size() ||
                          layout_.parts[part + 1].field != layout_.parts[part].field;
        if (!last) {
            ++c;
            continue;
        }
        std::array<double, kVectorSums> left{};
        const std::size_t count = c + 1, first = part - c;
        for_samples([&](const Samples& samples) {
            const auto plane = [&](std::size_t n) {
                return SamplePlane(value[n] - dot(gradient[n], cell.mean), gradient[n], samples);
            };
            if (count == 1) return add_scalar_residuals(samples, first, plane(0), left.data());
            const std::array<SamplePlane, 3> planes{plane(0), plane(1), plane(2)};
            add_vector_residuals(samples, first, planes.data(), left.data());
        });
        for (std::size_t s = 0; s < (count == 1 ? kScalarSums : kVectorSums); ++s)
            to.residuals.push_back(left[s] / of.mass);
        c = 0;
    }
    ++to.count;
}

void CellSums::take_cell(const moments::CutCell& cell, Scratch& scratch, CellFields& to) const {
    const MortonNode& node = cell.node;
    // Hard cells of a tile, and windows of one too large for neighbours, have one value.
    if (node.tile && (!cell.windows || node.edge > kLeafEdge)) return add_constant(node.index, to);
    const double half = 0.5 * (block_ - 1);
    Vec3i place;
    for (int axis = 0; axis < 3; ++axis)
        place[axis] = static_cast<int>(std::lround(cell.center[axis] - half)) - node.origin[axis];
    const MassScale scale(cell.sums.mass);
    if (cell.windows)
        fill_window(*cell.windows, place, scale, scratch);
    else
        fill_hard(node, place, scale, scratch);
    add_cell(
        cell.sums,
        [&](const auto& use) {
            use(Samples{&cube_, scratch.mass.data(), &scratch.value, {}, 1});
        },
        to);
}

void CutCells::take_node(const MortonNode& node, Scratch& scratch, CellFields& to) const {
    const moments::OverlapScratch* windows = windows_ ? &scratch.windows : nullptr;
    const auto take = [&](const MomentSums& sums, Vec3d center) {
        if (is_kept(sums.mass)) take_cell({node, windows, sums, center}, scratch, to);
    };
    if (!windows_) return moments::for_each_cell(volume_, node, cut_.block_voxels, take);
    bool gathered = false;
    moments::for_each_overlapping_cell(
        *windows_, node, scratch.windows, false, [&](const MomentSums& sums, Vec3d center) {
            if (!gathered && node.edge == kLeafEdge)
                for (std::size_t c = 0; c < components_.size(); ++c)
                    if (!is_own(components_[c]))
                        windows_->gather(node, *components_[c].values, scratch.around[c]);
            gathered = true;
            take(sums, center);
        });
}

void CellSums::fill_hard(const MortonNode& node, Vec3i place, const MassScale& scale,
                         Scratch& scratch) const {
    const int edge = block_;
    const float* density = volume_.leaves[node.index].value.data();
    const auto copy = [&](const float* from, auto&& change, std::vector<float>& to) {
        std::size_t n = 0;
        for (int x = 0; x < edge; ++x)
            for (int y = 0; y < edge; ++y) {
                const float* row = from + leaf_offset(place.x + x, place.y + y, place.z);
                for (int z = 0; z < edge; ++z) to[n++] = change(row[z]);
            }
    };
    copy(density, scale, scratch.mass);
    for (std::size_t c = 0; c < components_.size(); ++c) {
        const Component& component = components_[c];
        copy(
            is_own(component) ? density : component.values->leaf[node.index].data(),
            [&](float value) { return in_units(component, value); }, scratch.value[c]);
    }
}

template <int edge>
void CellSums::fill_window_of(const moments::OverlapScratch& windows, Vec3i place,
                              const MassScale& scale, Scratch& scratch) const {
    constexpr int reach = kLeafEdge + 2 * edge, halves = 2 * reach / edge;
    constexpr int across = 2 * edge;
    // Voxel and half cell of sample s along an axis, in the gathered cube: constants, so that rows are vectors.
    const auto voxel = [](int s) { return edge - edge / 2 + s; };
    const auto half = [](int s) { return 1 + s / (edge / 2); };
    const auto copy = [&](const float* from, auto&& change, float* to) {
        for (int x = 0; x < across; ++x)
            for (int y = 0; y < across; ++y, to += across) {
                const float* row =
                    from + ((place.x + voxel(x)) * reach + place.y + voxel(y)) * reach + place.z;
                for (int z = 0; z < across; ++z) to[z] = change(row[voxel(z)]);
            }
    };
    const float* density = windows.values.data();
    float* mass = scratch.mass.data();
    copy(density, scale, mass);
    for (std::size_t n = 0; n < cube_.count; ++n) mass[n] *= cube_.weight[n];
    if (windows.shared) {
        const Vec3i cell{2 * (place.x / edge), 2 * (place.y / edge), 2 * (place.z / edge)};
        constexpr int cells = reach / edge;
        const std::uint32_t joined = windows.joined[static_cast<std::size_t>(
            ((cell.x / 2 + 1) * cells + cell.y / 2 + 1) * cells + cell.z / 2 + 1)];
        float* to = mass;
        for (int x = 0; x < across; ++x)
            for (int y = 0; y < across; ++y, to += across) {
                const double* row = windows.window_sums.data() +
                                    ((cell.x + half(x)) * halves + cell.y + half(y)) * halves +
                                    cell.z;
                for (int z = 0; z < across; ++z)
                    if (to[z] > 0) to[z] /= static_cast<float>(row[half(z)]);
                if (!windows.apart) continue;
                const auto step = [&](int s) { return half(s) / 2 - 1; };
                for (int z = 0; z < across; ++z)
                    if (!(joined >> moments::neighbour_bit({step(x), step(y), step(z)}) & 1))
                        to[z] = 0;
            }
    }
    for (std::size_t c = 0; c < components_.size(); ++c) {
        const Component& component = components_[c];
        const float per_unit = 1 / component.unit, reference = component.reference;
        copy(
            is_own(component) ? density : scratch.around[c].data(),
            [=](float value) { return per_unit * (value - reference); }, scratch.value[c].data());
    }
}

void CellSums::fill_window(const moments::OverlapScratch& windows, Vec3i place,
                           const MassScale& scale, Scratch& scratch) const {
    if (block_ == 2) return fill_window_of<2>(windows, place, scale, scratch);
    if (block_ == 4) return fill_window_of<4>(windows, place, scale, scratch);
    fill_window_of<8>(windows, place, scale, scratch);
}

void CutCells::fill_brick(const Brick& brick, const MortonNode& node, const MassScale& scale,
                          Scratch& scratch) const {
    const auto volume = static_cast<float>(brick.sample_volume());
    for (std::size_t n = 0; n < kLeafVoxels; ++n)
        scratch.mass[n] = scale(brick.sample(static_cast<int>(n))) * volume;
    for (std::size_t c = 0; c < components_.size(); ++c) {
        const Component& component = components_[c];
        std::vector<float>& to = scratch.value[c];
        if (node.tile) {
            std::ranges::fill(to, tile_value(component, node.index));
            continue;
        }
        const float* from = is_own(component) ? brick.leaf->value.data()
                                              : component.values->leaf[node.index].data();
        for (std::size_t n = 0; n < kLeafVoxels; ++n) to[n] = in_units(component, from[n]);
    }
}

void CutCells::take_large_cell(std::size_t first, std::size_t last, Scratch& scratch,
                               CellFields& to) const {
    const Vec3d center = moments::cube_center(cell_of(nodes_[first]), cell_edge(nodes_[first]));
    struct Part {
        Brick brick;
        std::size_t node;
        Vec3d offset;
    };
    std::vector<Part> parts;
    MomentSums sums;
    for (std::size_t n = first; n < last; ++n) {
        const MortonNode& node = nodes_[n];
        Brick brick{node.origin, 1, nullptr, 0};
        if (node.tile)
            brick.value = std::max(0.0f, volume_.tiles[node.index].value),
            brick.spacing = static_cast<double>(node.edge) / kLeafEdge;
        else
            brick.leaf = &volume_.leaves[node.index];
        const Vec3d offset = moments::cube_center(node.origin, node.edge) - center;
        const MomentSums whole = moments::brick_sums(brick).whole;
        if (!(whole.mass > 0)) continue;
        moments::add_shifted(sums, whole, offset);
        parts.push_back({brick, n, offset});
    }
    if (parts.empty() || !is_kept(sums.mass)) return;
    const MassScale scale(sums.mass);
    add_cell(
        sums,
        [&](const auto& use) {
            for (const Part& part : parts) {
                fill_brick(part.brick, nodes_[part.node], scale, scratch);
                use(Samples{&cube_, scratch.mass.data(), &scratch.value, part.offset,
                            part.brick.spacing});
            }
        },
        to);
}

}  // namespace

struct OwnCellFields::State {
    std::vector<std::vector<VoxelField>> fields;
    Layout layout;
    std::vector<Component> components;
    CellSums sums;
    std::optional<FieldEntries> entries{};

    State(const Volume& volume, std::vector<std::vector<VoxelField>> own, int block_voxels,
          bool overlapping)
        : fields(std::move(own)),
          layout(fields),
          components(layout.components(volume, fields, 0)),
          sums(volume, components, layout, block_voxels, overlapping) {}
};

OwnCellFields::OwnCellFields(const Volume& volume, const std::string& name, int block_voxels,
                             bool overlapping)
    : state_(std::make_unique<State>(
          volume, std::vector<std::vector<VoxelField>>{{measure_field(volume, name)}}, block_voxels,
          overlapping)) {}
OwnCellFields::~OwnCellFields() = default;

moments::CellReceiver OwnCellFields::receiver() {
    State& state = *state_;
    const auto begin = [&state](std::size_t gaussians) {
        state.entries.emplace(state.fields, state.layout, gaussians);
    };
    const auto sink = [&state]() -> moments::CellSink {
        const auto scratch = std::make_shared<CellSums::Scratch>(state.sums.scratch());
        const auto made = std::make_shared<CellFields>();
        return [&state, scratch, made](const moments::CutCell& cell, std::size_t gaussian) {
            made->planes.clear(), made->residuals.clear();
            state.sums.take_cell(cell, *scratch, *made);
            state.entries->set(gaussian, made->planes.data(), made->residuals.data(), 1);
        };
    };
    return {begin, sink};
}

void OwnCellFields::move_to(Gaussians& model) && {
    if (state_->entries) std::move(*state_->entries).move_to(model);
}

bool add_by_cells(const Volume& volume, std::span<const Component> components, const Layout& layout,
                  const CutModel& model, const Progress& progress, FieldEntries& entries) {
    const CutCells cells(volume, components, layout, model);
    constexpr std::size_t kAtOnce = 64;
    std::vector<CellFields> made(kAtOnce);
    std::size_t done = 0;
    for (std::size_t task = 0; task < cells.task_count(); task += kAtOnce) {
        const std::size_t count = std::min(kAtOnce, cells.task_count() - task);
        vog::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
            made[n].planes.clear(), made[n].residuals.clear(), made[n].count = 0;
            cells.take(task + n, made[n]);
        });
        std::array<std::size_t, kAtOnce + 1> first{done};
        for (std::size_t n = 0; n < count; ++n) first[n + 1] = first[n] + made[n].count;
        done = first[count];
        if (done > model.gaussians) return false;
        vog::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
            for (std::size_t k = 0; k < made[n].count; ++k)
                entries.set(first[n] + k, &made[n].planes[layout.parts.size() * k],
                            &made[n].residuals[layout.residual_sums * k], 1);
        });
        if (progress)
            progress(static_cast<double>(task + count) / static_cast<double>(cells.task_count()));
    }
    return done == model.gaussians;
}

}  // namespace vog::joint
