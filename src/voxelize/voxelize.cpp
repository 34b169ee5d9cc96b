// voxelize.cpp: models back to volumes, block by block of the lattice.
#include "vog/voxelize.h"

#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>
#include <string>

#include "core/paging.h"
#include "core/parallel.h"
#include "vog/error.h"
#include "vog/levels.h"
#include "vog/periodic.h"
#include "vog/text.h"
#include "voxelize/cell_integrals.h"

namespace vog {

using namespace voxelization;

namespace {

// Voxels of a block, leaves one after the other in their order in a volume: 32 KiB of sums.
constexpr Vec3i kBlock{kLeafEdge, kLeafEdge, 8 * kLeafEdge};
constexpr std::size_t kBlockLeaves = 8;
constexpr std::size_t kBlocksAtOnce = 1024;  // 17 MB of leaves, and as much for each field
constexpr std::uint64_t kPairsAtOnce = std::uint64_t{1} << 23;  // 128 MB
constexpr std::uint64_t kMostPairs = std::uint64_t{1} << 40;
constexpr std::uint64_t kLeafBytes = sizeof(Leaf);
constexpr std::uint64_t kFieldLeafBytes = kLeafVoxels * sizeof(float);

/// Block of a voxel, rounded down.
Vec3i block_of(Vec3i voxel) { return {voxel.x >> 3, voxel.y >> 3, voxel.z >> 6}; }
Vec3i block_lower(Vec3i block) {
    return {block.x * kBlock.x, block.y * kBlock.y, block.z * kBlock.z};
}

/// A Gaussian at a block. Blocks are sorted by x, y, z, a block's Gaussians in the model's order.
struct Pair {
    std::uint64_t block;  ///< y and z of the block
    std::uint32_t slab;   ///< x of the block, from the first slab of the batch
    std::uint32_t gaussian;
    friend bool operator<(const Pair& a, const Pair& b) {
        if (a.slab != b.slab) return a.slab < b.slab;
        if (a.block != b.block) return a.block < b.block;
        return a.gaussian < b.gaussian;
    }
    bool same_block(const Pair& other) const { return slab == other.slab && block == other.block; }
};

/// Memory that the system can give without swapping, bytes; the largest number where it does not say.
std::uint64_t available_memory() {
    std::ifstream info("/proc/meminfo");
    for (std::string line; std::getline(info, line);)
        if (line.starts_with("MemAvailable:")) return std::stoull(line.substr(13)) * 1024;
    return std::numeric_limits<std::uint64_t>::max();
}

bool finite(const Affine& map) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            if (!std::isfinite(map.linear(r, c))) return false;
    return std::isfinite(map.translation.x) && std::isfinite(map.translation.y) &&
           std::isfinite(map.translation.z);
}

IndexBox common(const IndexBox& a, const IndexBox& b) {
    IndexBox both = a;
    for (int axis = 0; axis < 3; ++axis) {
        both.lower[axis] = std::max(a.lower[axis], b.lower[axis]);
        both.upper[axis] = std::min(a.upper[axis], b.upper[axis]);
    }
    return both;
}
bool is_empty(const IndexBox& box) {
    return box.lower.x > box.upper.x || box.lower.y > box.upper.y || box.lower.z > box.upper.z;
}

/// Voxels that lie within a box of the lattice, at least in part.
IndexBox voxels_in(const Box& box) {
    constexpr double kRounding = 1e-3;  // of a voxel, by which faces of levels may miss each other
    IndexBox inside;
    for (int axis = 0; axis < 3; ++axis) {
        inside.lower[axis] = static_cast<int>(std::floor(box.lower[axis] + 0.5 + kRounding));
        inside.upper[axis] = static_cast<int>(std::ceil(box.upper[axis] - 0.5 - kRounding));
    }
    return inside;
}

/// Voxels of one block that have mass.
struct BlockVoxels {
    std::vector<Leaf> leaves;
    std::vector<std::vector<std::array<float, kLeafVoxels>>> fields;  ///< [components][leaves]
    double mass = 0;
};

/// Buffers of a thread.
struct Local {
    CellSums sums;
    std::vector<IndexGaussian::Plane> planes{};
};

/// One voxelisation.
class Voxelizer {
  public:
    Voxelizer(const Gaussians& model, const Affine& world_from_index,
              const VoxelizeOptions& options)
        : model_(model),
          where_(model.source.empty() ? "model" : model.source),
          options_(options),
          world_from_index_(world_from_index),
          index_from_world_(inverse(world_from_index)),
          cell_(std::abs(determinant(world_from_index.linear))) {
        if (!finite(world_from_index) || !finite(index_from_world_) || !(cell_ > 0))
            throw Error(
                fmt::format("{}: a lattice of voxels of volume {:.3g}, expected a finite map that "
                            "is not singular",
                            where_, cell_));
        validate(model);
        if (model.size() > std::numeric_limits<std::uint32_t>::max())
            throw Error(
                fmt::format("{}: {} Gaussians, expected at most 2^32 - 1", where_, model.size()));
        result_.volume.name = options.name;
        result_.volume.source = model.source;
        result_.volume.world_from_index = world_from_index;
        result_.mass = mass_without_images(model);
        if (!(result_.mass > 0))
            throw Error(fmt::format("{}: no mass, expected Gaussians of density > 0", where_));
        if (options.fields) make_fields();
        if (const std::optional<Box> period = periodic_box(model)) {
            const IndexBox inside = voxels_in(transformed(index_from_world_, *period));
            options_.extent = options.extent ? common(inside, *options.extent) : inside;
        }
        limit_ = options.most_bytes ? options.most_bytes
                 : memory_limited() ? std::numeric_limits<std::uint64_t>::max()
                                    : available_memory() / 2;
        leaf_bytes_ = kLeafBytes + channels_of_fields() * kFieldLeafBytes;
    }

    Voxelized run() {
        const std::vector<std::uint64_t> slabs = count_pairs();
        std::uint64_t all = 0;
        for (const std::uint64_t n : slabs) all += n;
        std::uint64_t done = 0;
        for (std::size_t first = 0; first < slabs.size();) {
            std::size_t last = first + 1;
            std::uint64_t pairs = slabs[first];
            while (last < slabs.size() && pairs + slabs[last] <= kPairsAtOnce)
                pairs += slabs[last++];
            if (pairs > 0) {
                const BigVector<Pair> batch = pairs_of(first, last, pairs);
                voxelize_batch(batch, first_slab_ + static_cast<int>(first),
                               static_cast<double>(done) / static_cast<double>(all),
                               static_cast<double>(pairs) / static_cast<double>(all));
            }
            done += pairs;
            first = last;
        }
        if (result_.volume.leaves.empty())
            throw Error(fmt::format(
                "{}: no mass in the extent, expected voxels that the model reaches", where_));
        finish_fields();
        return std::move(result_);
    }

  private:
    std::size_t channels_of_fields() const {
        std::size_t count = 0;
        for (const VoxelField& field : result_.fields) count += field.component.size();
        return count;
    }

    void make_fields() {
        const auto add = [&](const std::string& name, const std::string& unit,
                             std::size_t components) {
            if (name == options_.name)
                throw Error(
                    fmt::format("{}: field '{}' has the name of the volume, expected another name "
                                "of the volume",
                                where_, name));
            VoxelField& field = result_.fields.emplace_back();
            field.name = name;
            field.unit = unit;
            field.component.resize(components);
        };
        for (const ScalarField& field : model_.fields.scalar)
            if (!field.is_measure) add(field.name, field.unit, 1);
        for (const VectorField& field : model_.fields.vector) add(field.name, field.unit, 3);
        if (result_.fields.empty())
            throw Error(fmt::format(
                "{}: no field{}, expected a model converted with --field", where_,
                model_.fields.empty() ? "" : " but the measure itself, which the volume has"));
    }

    /// Box of Gaussian i, within the extent.
    IndexBox box_of(const IndexGaussian& gaussian) const {
        return options_.extent ? common(gaussian.box, *options_.extent) : gaussian.box;
    }

    [[noreturn]] void fail_size(double bytes) const {
        throw Error(
            fmt::format("{}: the voxels take more than {:.3g} GB, expected at most {:.3g} GB: "
                        "larger voxels, or --memory, with which they lie in a scratch file",
                        where_, bytes * 1e-9, static_cast<double>(limit_) * 1e-9));
    }

    /// Numbers of pairs of the slabs of blocks along x, from first_slab_ on.
    std::vector<std::uint64_t> count_pairs() {
        int least = std::numeric_limits<int>::max(), most = std::numeric_limits<int>::min();
        constexpr double kBallVolume = 4.18879020478639;
        for (std::size_t i = 0; i < model_.size(); ++i) {
            const IndexGaussian gaussian = index_gaussian(model_, i, index_from_world_);
            const IndexBox box = box_of(gaussian);
            if (is_empty(box)) continue;
            least = std::min(least, box.lower.x >> 3);
            most = std::max(most, box.upper.x >> 3);
            // Certainly active: the voxels inside one support.
            if (!options_.extent) {
                const double voxels = kBallVolume * std::pow(gaussian.cutoff, 3) * gaussian.g11 *
                                      gaussian.g22 * gaussian.g33;
                const double bytes = voxels / kLeafVoxels * static_cast<double>(leaf_bytes_);
                if (bytes > static_cast<double>(limit_)) fail_size(bytes);
            }
            keep_memory_at(i);
        }
        if (least > most) return {};
        first_slab_ = least;
        const auto count = static_cast<std::size_t>(std::int64_t{most} - least + 1);
        constexpr std::size_t kMostSlabs = std::size_t{1} << 24;
        if (count > kMostSlabs)
            throw Error(
                fmt::format("{}: {} voxels along x, expected at most {}: a larger voxel size",
                            where_, count * 8, kMostSlabs * 8));
        std::vector<std::uint64_t> slabs(count + 1);
        std::uint64_t all = 0;
        for (std::size_t i = 0; i < model_.size(); ++i) {
            const IndexBox box = box_of(index_gaussian(model_, i, index_from_world_));
            if (is_empty(box)) continue;
            const Vec3i lower = block_of(box.lower), upper = block_of(box.upper);
            const auto edge = [](int a, int b) { return static_cast<std::uint64_t>(b - a + 1); };
            const std::uint64_t face = edge(lower.y, upper.y) * edge(lower.z, upper.z);
            slabs[static_cast<std::size_t>(lower.x - first_slab_)] += face;
            slabs[static_cast<std::size_t>(upper.x - first_slab_) + 1] -= face;
            if (face > kMostPairs || (all += face * edge(lower.x, upper.x)) > kMostPairs)
                fail_size(static_cast<double>(kMostPairs) * kLeafBytes);
            keep_memory_at(i);
        }
        for (std::size_t n = 1; n < slabs.size(); ++n) slabs[n] += slabs[n - 1];
        slabs.pop_back();
        return slabs;
    }

    /// Gaussians at the blocks of the slabs [first, last), sorted.
    BigVector<Pair> pairs_of(std::size_t first, std::size_t last, std::uint64_t count) const {
        const int lower_slab = first_slab_ + static_cast<int>(first),
                  upper_slab = first_slab_ + static_cast<int>(last) - 1;
        BigVector<Pair> pairs(count);
        std::atomic<std::size_t> end{0};
        constexpr std::size_t kPiece = 4096;
        vog::parallel_for(
            tbb::blocked_range<std::size_t>(0, model_.size(), kPiece), [&](const auto& range) {
                std::vector<Pair> some;
                for (std::size_t i = range.begin(); i < range.end(); ++i) {
                    const IndexBox box = box_of(index_gaussian(model_, i, index_from_world_));
                    if (is_empty(box)) continue;
                    const Vec3i lower = block_of(box.lower), upper = block_of(box.upper);
                    for (int x = std::max(lower.x, lower_slab); x <= std::min(upper.x, upper_slab);
                         ++x)
                        for (int y = lower.y; y <= upper.y; ++y)
                            for (int z = lower.z; z <= upper.z; ++z)
                                some.push_back({key(y, z),
                                                static_cast<std::uint32_t>(x - lower_slab),
                                                static_cast<std::uint32_t>(i)});
                }
                std::ranges::copy(
                    some, pairs.begin() + static_cast<std::ptrdiff_t>(end.fetch_add(some.size())));
                keep_memory();
            });
        tbb::parallel_sort(pairs.begin(),
                           pairs.end());  // no two are equal: one order for any number of threads
        return pairs;
    }

    // Indices lie within 2^30: blocks of 8 within 2^27.
    static constexpr int kShift = 1 << 28;
    static std::uint64_t key(int y, int z) {
        return (static_cast<std::uint64_t>(y + kShift) << 32) |
               static_cast<std::uint64_t>(z + kShift);
    }
    Vec3i block_at(const Pair& pair, int slab) const {
        return {slab + static_cast<int>(pair.slab), static_cast<int>(pair.block >> 32) - kShift,
                static_cast<int>(pair.block & 0xffffffffu) - kShift};
    }

    /// slab  first of the batch
    void voxelize_batch(const BigVector<Pair>& pairs, int slab, double done, double share) {
        std::vector<std::size_t> begin;  // of each block in `pairs`
        for (std::size_t n = 0; n < pairs.size(); ++n)
            if (n == 0 || !pairs[n].same_block(pairs[n - 1])) begin.push_back(n);
        begin.push_back(pairs.size());
        std::vector<BlockVoxels> made;
        for (std::size_t first = 0; first + 1 < begin.size(); first += kBlocksAtOnce) {
            const std::size_t count = std::min(kBlocksAtOnce, begin.size() - 1 - first);
            made.assign(count, {});
            vog::parallel_for(std::size_t{0}, count, [&](std::size_t n) {
                const std::size_t from = begin[first + n], to = begin[first + n + 1];
                made[n] = voxels_of(block_at(pairs[from], slab), {pairs.data() + from, to - from});
            });
            for (const BlockVoxels& block : made) take(block);
            if (options_.progress)
                options_.progress(done + share * static_cast<double>(first + count) /
                                             static_cast<double>(begin.size() - 1));
        }
    }

    BlockVoxels voxels_of(Vec3i block, std::span<const Pair> pairs) {
        const std::size_t components = channels_of_fields();
        Local& local = locals_.local();
        const IndexBox whole{block_lower(block), block_lower(block) + kBlock - Vec3i{1, 1, 1}};
        const IndexBox box = options_.extent ? common(whole, *options_.extent) : whole;
        local.sums.clear(whole.lower);
        for (const Pair& pair : pairs) {
            const IndexGaussian gaussian = index_gaussian(model_, pair.gaussian, index_from_world_);
            if (components > 0)
                field_planes(model_, pair.gaussian, world_from_index_, gaussian, local.planes);
            local.sums.add(gaussian, local.planes, box, normal_);
        }
        return leaves_of(whole.lower, local.sums, components);
    }

    BlockVoxels leaves_of(Vec3i lower, const CellSums& sums, std::size_t components) const {
        BlockVoxels block;
        block.fields.resize(components);
        const std::span<const double> mass = sums.channel(0);
        for (std::size_t n = 0; n < kBlockLeaves; ++n) {
            Leaf leaf;
            leaf.origin = {lower.x, lower.y, lower.z + static_cast<int>(n) * kLeafEdge};
            const auto place = [&](int offset) {
                return static_cast<std::size_t>(offset >> 3) * static_cast<std::size_t>(kBlock.z) +
                       n * kLeafEdge + static_cast<std::size_t>(offset & 7);
            };
            for (int offset = 0; offset < kLeafVoxels; ++offset) {
                const double density = mass[place(offset)] / cell_;
                if (!(density <= std::numeric_limits<float>::max()))
                    throw Error(fmt::format(
                        "{}: density {:.4g} in a voxel, expected at most {:.4g}: larger voxels",
                        where_, density, std::numeric_limits<float>::max()));
                const auto value = static_cast<float>(density);
                if (!(value > 0)) continue;
                leaf.set(offset, value);
                block.mass += value * cell_;
            }
            if (leaf.active_count() == 0) continue;
            for (std::size_t c = 0; c < components; ++c) {
                const std::span<const double> sum = sums.channel(c + 1);
                std::array<float, kLeafVoxels>& values = block.fields[c].emplace_back();
                values.fill(0);
                for (int offset = 0; offset < kLeafVoxels; ++offset)
                    if (leaf.active(offset))
                        values[static_cast<std::size_t>(offset)] =
                            static_cast<float>(sum[place(offset)] / mass[place(offset)]);
            }
            block.leaves.push_back(leaf);
        }
        return block;
    }

    /// Appends a block's leaves: the next ones in the order of the volume.
    void take(const BlockVoxels& block) {
        const auto append = [](auto& to, const auto& from) {
            if (to.size() + from.size() > to.capacity()) {
                auto larger = std::remove_reference_t<decltype(to)>{};
                larger.reserve(std::max(2 * to.capacity(), to.size() + from.size()));
                append_kept(larger, to);
                to = std::move(larger);
            }
            to.insert(to.end(), from.begin(), from.end());
        };
        append(result_.volume.leaves, block.leaves);
        std::size_t c = 0;
        for (VoxelField& field : result_.fields)
            for (VoxelValues& component : field.component)
                append(component.leaf, block.fields[c++]);
        result_.voxel_mass += block.mass;
        const std::uint64_t bytes = result_.volume.leaves.size() * leaf_bytes_;
        if (bytes > limit_) fail_size(static_cast<double>(bytes));
        keep_memory();
    }

    /// Ranges of the fields.
    void finish_fields() {
        for (VoxelField& field : result_.fields) {
            field.lower = std::numeric_limits<double>::infinity();
            field.upper = -field.lower;
            for (std::size_t n = 0; n < result_.volume.leaves.size(); ++n) {
                for (int offset = 0; offset < kLeafVoxels; ++offset) {
                    if (!result_.volume.leaves[n].active(offset)) continue;
                    const auto at = static_cast<std::size_t>(offset);
                    double value = field.component[0].leaf[n][at];
                    if (field.is_vector())
                        value = length(Vec3d{value, field.component[1].leaf[n][at],
                                             field.component[2].leaf[n][at]});
                    field.lower = std::min(field.lower, value);
                    field.upper = std::max(field.upper, value);
                }
                keep_memory_at(n);
            }
        }
    }

    const Gaussians& model_;
    std::string where_;
    VoxelizeOptions options_;
    Affine world_from_index_, index_from_world_;
    double cell_;  // volume of a voxel, world units
    std::uint64_t limit_ = 0, leaf_bytes_ = 0;
    int first_slab_ = 0;
    NormalTable normal_;
    tbb::enumerable_thread_specific<Local> locals_{[this] {
        return Local{{kBlock, 1 + channels_of_fields()}};
    }};
    Voxelized result_;
};

}  // namespace

Affine voxel_lattice(const Gaussians& model, double voxel_size) {
    if (!(voxel_size > 0) || !std::isfinite(voxel_size))
        throw Error(
            fmt::format("voxel size {}, expected a finite number > 0, in world units", voxel_size));
    const Vec3d edges{voxel_size, voxel_size, voxel_size};
    const std::optional<Box> period = periodic_box(model);
    return affine_from_voxels(edges, period ? period->lower + 0.5 * edges : model.origin);
}

Affine lattice_like(std::span<const Volume> volumes, std::optional<IndexBox>* extent) {
    if (volumes.empty()) throw Error("no volume, expected one with the lattice");
    const Affine lattice = volumes[finest_first(volumes).front()].world_from_index;
    if (!extent) return lattice;
    const Affine index_from_world = inverse(lattice);
    Box box;
    for (const Volume& volume : volumes) {
        const IndexBox active = active_box(volume);
        for (int corner = 0; corner < 8; ++corner) {
            Vec3d at;
            for (int axis = 0; axis < 3; ++axis)
                at[axis] = corner >> axis & 1 ? active.upper[axis] + 0.5 : active.lower[axis] - 0.5;
            box.include(index_from_world(volume.world_from_index(at)));
        }
    }
    *extent = voxels_in(box);
    return lattice;
}

Voxelized voxelize(const Gaussians& model, const Affine& world_from_index,
                   const VoxelizeOptions& options) {
    return Voxelizer(model, world_from_index, options).run();
}

}  // namespace vog
