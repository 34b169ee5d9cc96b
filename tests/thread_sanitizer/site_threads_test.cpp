// site_threads_test.cpp: Views of a site that move on while chunks are read in the background.
#include <gtest/gtest.h>

#include <stdlib.h>

#include <condition_variable>
#include <filesystem>
#include <mutex>

#include "support/scenes.h"
#include "vog/lod.h"
#include "vog/site.h"

namespace vog::test {

TEST(site_threads, views_move_on_while_chunks_are_read) {
    std::string pattern = (std::filesystem::temp_directory_path() / "vog-test-XXXXXX").string();
    const std::filesystem::path folder = ::mkdtemp(pattern.data());
    Gaussians model = random_gaussians(30000, 0.005, 0.01, 3);
    {
        const Hierarchy hierarchy = build_hierarchy(model);
        SiteWriter site(folder);
        site.add("random", model, hierarchy);
        site.finish();
    }
    const Box box = view_box(model);
    SiteCut cut(folder, 0, 1 << 20), waiting(folder);
    std::mutex mutex;
    std::condition_variable changed;
    int arrived = 0;
    const auto tell = [&] {
        const std::lock_guard lock(mutex);
        ++arrived;
        changed.notify_all();
    };
    const auto frame_at = [&](double azimuth, double distance) {
        Orbit orbit;
        orbit.azimuth_degrees = azimuth;
        orbit.distance_radii = distance;
        return frame_of(orbit_view(box, orbit), 600, 600);
    };
    for (int turn = 0; turn < 40; ++turn)
        (void)cut.choose_available(frame_at(9.0 * turn, turn % 2 ? 0.2 : 3), {}, tell);
    const CameraFrame last = frame_at(10, 2);
    (void)cut.choose_available(last, {}, tell);
    for (int seen = 0; cut.report().pending > 0;) {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return arrived > seen; });
        seen = arrived;
        lock.unlock();
        (void)cut.choose_available(last, {}, tell);
    }
    EXPECT_EQ(cut.fault(), "");
    EXPECT_EQ(cut.choose_available(last, {}, tell).mean, waiting.choose(last).mean);
    std::filesystem::remove_all(folder);
}

}  // namespace vog::test
