// far_from_origin_test.cpp: models of data far from the world's origin are as good as models at it.
#include <gtest/gtest.h>

#include <vector>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "support/scenes.h"
#include "vog/compare.h"
#include "vog/convert.h"
#include "vog/lod.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

constexpr int kSize_px = 128;

/// Place of data: moved by `voxels` of this edge along (1, -0.7, 0.3), in world space or by indices.
struct Place {
    double voxels = 0, edge = 1;
    bool by_index = false;

    Vec3d shift() const { return voxels * edge * Vec3d{1, -0.7, 0.3}; }
};
const std::vector<Place> kPlaces{{1e3, 1},  {1e6, 0.1},    {5e7 + 1, 0.1},
                                 {1e9, 10}, {1e9, 0.0123}, {1e9, 1, true}};

Volume volume_at(Volume volume, double edge, const Place& place) {
    volume.world_from_index = {{{Vec3d{edge, 0, 0}, {0, edge, 0}, {0, 0, edge}}}, {}};
    if (!place.by_index) {
        volume.world_from_index.translation = place.shift();
        return volume;
    }
    // A multiple of the largest tile's edge.
    const int step = static_cast<int>(place.voxels) / 4096 * 4096;
    for (Leaf& leaf : volume.leaves) leaf.origin = leaf.origin + Vec3i{step, -step, step};
    for (Tile& tile : volume.tiles) tile.origin = tile.origin + Vec3i{step, -step, step};
    return volume;
}
Volume cloud_at(const Place& place) {
    return volume_at(sample_cloud({.size = 64}), place.edge, place);
}

/// A pinhole, and parallel rays. Oblique: rays in faces of voxels would have either side's value.
std::vector<Camera> views(const Box& box) {
    Orbit parallel;
    parallel.orthographic = true;
    return {paper_view(box), orbit_view(box, parallel)};
}

std::vector<DepthImage> pictures(const Volume& volume) {
    const VoxelGrid grid = voxel_grid(volume);
    std::vector<DepthImage> all;
    for (const Camera& camera : views(world_box(volume)))
        all.push_back(render_reference(std::span(&grid, 1), camera, kSize_px, kSize_px));
    return all;
}
std::vector<DepthImage> pictures(const Gaussians& model) {
    std::vector<DepthImage> all;
    for (const Camera& camera : views(model.box))
        all.push_back(render_splat(model, camera, kSize_px, kSize_px));
    return all;
}

/// Relative L2 of T over all pictures. `edge` scales T to that of voxels of edge 1.
double distance(const std::vector<DepthImage>& reference, const std::vector<DepthImage>& images,
                double reference_edge = 1, double edge = 1) {
    double error2 = 0, norm2 = 0;
    for (std::size_t n = 0; n < reference.size(); ++n)
        for (std::size_t i = 0; i < images[n].depth.size(); ++i) {
            const double t = reference[n].depth[i] / reference_edge;
            const double d = images[n].depth[i] / edge - t;
            error2 += d * d, norm2 += t * t;
        }
    return std::sqrt(error2 / norm2);
}

/// Conversions by name, for the message of a failure.
template <class Data, class Convert>
void expect_as_good(const char* name, const Convert& convert, const Data& data_at) {
    const Gaussians near = convert(data_at(Place{}));
    EXPECT_EQ(near.origin, Vec3d{}) << name;
    const std::vector<DepthImage> truth = pictures(data_at(Place{}));
    const double error = distance(truth, pictures(near));
    EXPECT_LT(error, 0.3) << name;
    for (const Place& place : kPlaces) {
        SCOPED_TRACE(testing::Message() << name << ", " << place.voxels << " voxels of "
                                        << place.edge << (place.by_index ? ", by index" : ""));
        const auto data = data_at(place);
        const std::vector<DepthImage> moved_truth = pictures(data);
        // Doubles at 1e9 voxels resolve 1e-7 voxels, a hit or miss of a few rays along faces.
        EXPECT_LT(distance(truth, moved_truth, 1, place.edge), 1e-3);
        const Gaussians model = convert(data);
        // 1000 voxels are 20 radii.
        EXPECT_EQ(model.origin != Vec3d{}, place.voxels > 1e3);
        EXPECT_NEAR(distance(moved_truth, pictures(model)), error, 0.02 * error);
    }
}

MomentOptions moments(int block, std::size_t budget) {
    MomentOptions options;
    options.block_voxels = block;
    options.budget = budget;
    return options;
}

}  // namespace

TEST(far_from_origin, volumes_are_converted_as_well) {
    const auto by_moments = [](const MomentOptions& options) {
        return [options](const Volume& volume) { return convert_moments(volume, options); };
    };
    const auto by_paper = [](Strategy strategy) {
        return [strategy](const Volume& volume) {
            PaperOptions options;
            options.strategy = strategy;
            options.amplitude = Amplitude::mass;
            return convert_paper(volume, options);
        };
    };
    expect_as_good("block 2", by_moments(moments(2, 0)), cloud_at);
    expect_as_good("block 4", by_moments(moments(4, 0)), cloud_at);
    expect_as_good("budget", by_moments(moments(0, 1000)), cloud_at);
    expect_as_good("smart", by_paper(Strategy::smart_grouping), cloud_at);
    expect_as_good("tree", by_paper(Strategy::tree_mirror), cloud_at);
}

TEST(far_from_origin, the_default_measures_the_same_error) {
    MomentReport near, far;
    const Gaussians model = convert_moments(cloud_at({}), {}, &near);
    const Gaussians moved_model = convert_moments(cloud_at({1e9, 0.1}), {}, &far);
    EXPECT_NEAR(far.measured_error, near.measured_error, 0.05 * near.measured_error);
    EXPECT_NEAR(static_cast<double>(moved_model.size()), static_cast<double>(model.size()),
                0.05 * static_cast<double>(model.size()));
}

TEST(far_from_origin, levels_of_a_mesh_share_their_octree) {
    const auto levels_at = [](const Place& place) {
        Levels levels;
        for (const Volume& level : sample_levels({.size = 64})) {
            const double edge = place.edge * 64 * length(level.world_from_index.linear.column(0));
            Volume moved_level = level;
            moved_level.world_from_index.linear = {
                {Vec3d{edge, 0, 0}, Vec3d{0, edge, 0}, Vec3d{0, 0, edge}}};
            moved_level.world_from_index.translation =
                64 * place.edge * level.world_from_index.translation + place.shift();
            levels.volumes.push_back(moved_level);
        }
        return levels;
    };
    const auto error_at = [&](const Place& place, std::size_t& count) {
        const Levels levels = levels_at(place);
        const Gaussians model = convert_moments(composite(levels), moments(0, 2000));
        count = model.size();
        const LevelGrids grids = level_grids(levels);
        std::vector<DepthImage> truth;
        for (const Camera& camera : views(model.box))
            truth.push_back(render_reference(grids, camera, kSize_px, kSize_px));
        return distance(truth, pictures(model));
    };
    std::size_t count = 0, moved_count = 0;
    const double error = error_at({}, count);
    for (const Place& place : {Place{1e6, 0.1}, Place{1e9, 1}, Place{1e9, 0.1}}) {
        SCOPED_TRACE(testing::Message() << place.voxels << " voxels of " << place.edge);
        EXPECT_NEAR(error_at(place, moved_count), error, 0.02 * error);
        EXPECT_NEAR(static_cast<double>(moved_count), static_cast<double>(count), 20);
    }
}

TEST(far_from_origin, hierarchies_cuts_and_coarser_models_are_the_same) {
    const auto pictures_at = [](const Place& place) {
        const Volume volume = cloud_at(place);
        Gaussians model = convert_moments(volume, moments(2, 0));
        const Gaussians coarser = coarsen(model, 500);
        const Hierarchy hierarchy = build_hierarchy(model, {inverse(volume.world_from_index)});
        SplatOptions options;
        options.hierarchy = &hierarchy;
        options.cut.pixel_error = 6;
        SplatRenderer renderer(model, options);
        std::vector<DepthImage> all = pictures(coarser);
        for (const Camera& camera : views(model.box)) {
            all.push_back(renderer.render(camera, kSize_px, kSize_px));
            EXPECT_GT(renderer.cut_report().nodes, 50u);
            all.push_back(render_trace(trace_scene(model), camera, kSize_px, kSize_px));
            all.push_back(render_splat(model, camera, kSize_px, kSize_px, {.aabb_sigma = 1.5}));
            all.push_back(
                render_trace(trace_scene(model, {.aabb_sigma = 1.5}), camera, kSize_px, kSize_px));
        }
        return all;
    };
    const std::vector<DepthImage> near = pictures_at({});
    for (const Place& place : {kPlaces[1], kPlaces[4], kPlaces[5]})
        EXPECT_LT(distance(near, pictures_at(place), 1, place.edge), 1e-3)
            << place.voxels << " voxels of " << place.edge;
}

TEST(far_from_origin, particles_keep_their_distances) {
    const Points universe = sample_particles({.size = 16});
    const auto points_at = [&](double offset) {
        Points points = universe;
        for (Vec3d& position : points.position) position = position + offset * Vec3d{1, -0.7, 0.3};
        return points;
    };
    const auto pictures_at = [&](double offset) {
        const Points points = points_at(offset);
        std::vector<DepthImage> all;
        const auto add = [&](const Gaussians& model) {
            EXPECT_EQ(model.origin != Vec3d{}, offset > 0);
            for (DepthImage& image : pictures(model)) all.push_back(std::move(image));
        };
        PointOptions options;
        add(convert_points(points, options));
        options.block_voxels = 2;
        add(convert_points(points, options));
        options.block_voxels = 0, options.budget = 500;
        add(convert_points(points, options));
        add(convert_points_paper(points));
        return all;
    };
    const std::vector<DepthImage> near = pictures_at(0);
    for (const double offset : {1e7, 5000000.1 * 16, 1e9})
        EXPECT_LT(distance(near, pictures_at(offset)), 1e-3) << offset;
}

TEST(far_from_origin, one_particle_is_where_it_is) {
    Points points;
    points.position = {{5000000.1, 1e9, -7}};
    PointOptions options;
    options.radius = 0.1;
    const Gaussians model = convert_points(points, options);
    EXPECT_LT(length(world_mean(model, 0) - points.position[0]), 1e-6);
    points.position = {{1, 2, 3}};
    EXPECT_EQ(convert_points(points, options).origin, Vec3d{});
}

}  // namespace vog::test
