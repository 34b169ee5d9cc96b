// interrupt_test.cpp: exceptions from a thread's InterruptCheck end every long call. Checks have
// period 0, so that their number does not depend on time.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "render/trace/trace.h"
#include "support/data.h"
#include "vog/vog.h"

namespace vog {
namespace {

struct Stop {};  // not a std::exception, so that no handler of the library catches it

/// Number of checks in a complete call.
int count_checks(const std::function<void()>& call) {
    int checks = 0;
    const InterruptCheck check([&] { ++checks; }, 0);
    call();
    return checks;
}

/// Ends the call at check number `at`: it must throw Stop, and no further check may follow.
void expect_ends_at(const std::string& name, int at, const std::function<void()>& call) {
    int checks = 0;
    const InterruptCheck check(
        [&] {
            if (++checks == at) throw Stop{};
        },
        0);
    EXPECT_THROW(call(), Stop) << name << ", check " << at;
    EXPECT_EQ(checks, at) << name;
}

void expect_ends_anywhere(const std::string& name, const std::function<void()>& call) {
    expect_ends_at(name, 1, call);
    // The number of checks is reproducible on one thread.
    const ThreadLimit limit(1);
    const int all = count_checks(call);
    ASSERT_GT(all, 2) << name;
    for (const int at : {2, 1 + all / 4, 1 + all / 2, all}) expect_ends_at(name, at, call);
}

const Volume& cloud() {
    static const Volume volume = sample_cloud({.size = 64});
    return volume;
}

TEST(interrupt, ends_every_long_call_wherever_it_is) {
    const Points points = sample_particles({.size = 12});
    const Gaussians model = convert_moments(cloud(), {.block_voxels = 2});
    const Camera camera = paper_view(model.box);
    const VoxelGrid grid = voxel_grid(cloud());
    const TraceScene scene = trace_scene(model);
    const Levels levels{sample_levels({.size = 64}), {}};
    const test::TempDir dir;
    write_vdb(dir / "cloud.vdb", cloud());

    expect_ends_anywhere("sample", [] { (void)sample_cloud({.size = 64}); });
    expect_ends_anywhere("read", [&] { (void)read_vdb(dir / "cloud.vdb"); });
    expect_ends_anywhere("block", [&] { (void)convert_moments(cloud(), {.block_voxels = 4}); });
    expect_ends_anywhere("budget", [&] { (void)convert_moments(cloud(), {.budget = 500}); });
    expect_ends_anywhere("error", [&] { (void)convert_moments(cloud(), {.error = 0.1}); });
    expect_ends_anywhere("paper", [&] { (void)convert_paper(cloud()); });
    expect_ends_anywhere("composite", [&] { (void)composite(levels); });
    expect_ends_anywhere("levels",
                         [&] { (void)convert_moments(composite(levels), {.budget = 500}); });
    expect_ends_anywhere("particles", [&] { (void)convert_points(points); });
    expect_ends_anywhere("fewer", [&] { (void)convert_points(points, {.budget = 300}); });
    expect_ends_anywhere("splat", [&] { (void)render_splat(model, camera, 256, 256); });
    expect_ends_at("scene", 1, [&] { (void)trace_scene(model); });
    expect_ends_anywhere("trace", [&] { (void)render_trace(scene, camera, 64, 64); });
    expect_ends_anywhere("reference", [&] { (void)render_reference({&grid, 1}, camera, 64, 64); });
}

TEST(interrupt, leaves_the_renderer_usable) {
    const Gaussians model = convert_moments(cloud(), {.block_voxels = 2});
    const Camera camera = paper_view(model.box);
    const DepthImage expected = render_splat(model, camera, 200, 100);
    SplatRenderer renderer(model);
    for (int at = 1; at < 40; at += 3) {
        int checks = 0;
        const InterruptCheck check(
            [&] {
                if (++checks == at) throw Stop{};
            },
            0);
        try {
            (void)renderer.render(camera, 200, 100);
        } catch (const Stop&) {
        }
    }
    EXPECT_EQ(renderer.render(camera, 200, 100).depth, expected.depth);
}

TEST(interrupt, leaves_no_file_half_written) {
    const test::TempDir dir;
    const VolumeSet volumes{{{cloud()}, {}}, Overlap::add};
    int checks = 0;
    const InterruptCheck check(
        [&] {
            if (++checks == 40) throw Stop{};
        },
        0);
    EvaluateOptions options{.width = 32, .height = 32, .repeats = 1};
    EXPECT_THROW((void)evaluate(volumes, dir / "out", options), Stop);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(dir / ""))
        EXPECT_TRUE(entry.is_directory()) << entry.path();
}

TEST(interrupt, is_limited_to_its_thread_and_lifetime) {
    std::atomic<int> checks{0};
    {
        const InterruptCheck outer([&] { checks += 1000000; }, 0);
        {
            const InterruptCheck check([&] { ++checks; }, 0);
            std::thread([] { (void)sample_cloud({.size = 64}); }).join();
            EXPECT_EQ(checks, 0) << "a call of another thread used this check";
            (void)sample_cloud({.size = 64});
        }
        EXPECT_GT(checks, 0);
        EXPECT_LT(checks, 1000000) << "the inner check hides the outer one";
        (void)sample_cloud({.size = 64});
        EXPECT_GE(checks, 1000000) << "the outer check is active again";
    }
    const int before = checks;
    (void)sample_cloud({.size = 64});
    EXPECT_EQ(checks, before);
}

TEST(interrupt, check_may_call_the_library) {
    const DepthImage black(8, 8);
    int checks = 0;
    const InterruptCheck check(
        [&] {
            ++checks;
            (void)shade(black, named_transfer_function("gray"));
        },
        0);
    (void)sample_cloud({.size = 64});
    EXPECT_GT(checks, 2);
}

TEST(interrupt, check_is_called_once_per_period) {
    int checks = 0;
    const InterruptCheck check([&] { ++checks; }, 1e6);
    (void)convert_moments(cloud(), {.budget = 500});
    EXPECT_EQ(checks, 0);
}

}  // namespace
}  // namespace vog
