// accumulation_test.cpp: progressive pictures: which changes start them again, and coarse frames of
// a moving camera. Time is a clock of the tests: no test depends on the machine's speed.
#include <thread>

#include "session/session.h"
#include "support/scenes.h"
#include "viewer/headless.h"

namespace vog::test {

using namespace viewer;

class accumulation : public headless {
  protected:
    void SetUp() override {
        headless::SetUp();
        if (IsSkipped()) return;
        session_.emplace(
            [](const std::vector<std::string>&) {
                viewer::Content content;
                content.model = random_gaussians(300, 0.01, 0.2, 41);
                return content;
            },
            [this] { return clock_s_; });
        session_->settings.subframes = 8;
        session_->open({"random"});
        rest();
    }
    void TearDown() override { session_.reset(); }
    /// A frame, a hundredth of a second after the one before.
    void frame() {
        clock_s_ += 0.01;
        session_->update({80, 60});
    }
    /// Frames until nothing would change. A session that never rests ends by ctest's time limit.
    void rest() {
        for (int n = 0; n < 2 || !session_->at_rest(); ++n) {
            frame();
            std::this_thread::yield();  // to the threads that load and render
        }
    }
    double clock_s_ = 0;
    std::optional<Session> session_;
};

TEST_F(accumulation, sub_frames_add_up_to_their_mean) {
    EXPECT_EQ(session_->left().subframes(), 8);
    const DepthImage mean =
        render_gl(random_gaussians(300, 0.01, 0.2, 41), session_->camera, 80, 60, 8);
    const SumImage shown = session_->left().read();
    for (std::size_t n = 0; n < mean.depth.size(); ++n)
        ASSERT_NEAR(shown.value[n], mean.depth[n], 1e-6);
}

TEST_F(accumulation, colours_render_nothing) {
    const int revision = session_->left().revision();
    load_map(session_->look, "viridis");
    session_->look.extinction *= 3;
    session_->look.gamma = 2;
    session_->look_changed();
    frame();
    frame();
    EXPECT_EQ(session_->left().revision(), revision);
}

TEST_F(accumulation, a_moved_camera_begins_anew) {
    session_->settings.coarse_moving = false;
    session_->camera = orbited(session_->camera, 0.1, 0);
    frame();
    EXPECT_EQ(session_->left().subframes(), 1);
    frame();
    EXPECT_EQ(session_->left().subframes(), 2);
    rest();
    EXPECT_EQ(session_->left().subframes(), 8);
}

TEST_F(accumulation, fewer_sub_frames_than_there_are_begin_anew) {
    session_->settings.subframes = 3;
    rest();
    EXPECT_EQ(session_->left().subframes(), 3);
    const DepthImage three =
        render_gl(random_gaussians(300, 0.01, 0.2, 41), session_->camera, 80, 60, 3);
    const SumImage shown = session_->left().read();
    for (std::size_t n = 0; n < three.depth.size(); ++n)
        ASSERT_NEAR(shown.value[n], three.depth[n], 1e-6);
}

TEST_F(accumulation, a_moving_camera_has_one_sub_frame_until_it_rests) {
    for (int n = 0; n < 5; ++n) {
        session_->camera = orbited(session_->camera, 0.01, 0);
        frame();
        frame();
        EXPECT_TRUE(session_->moving());
        EXPECT_EQ(session_->left().subframes(), 1);
    }
    rest();
    EXPECT_EQ(session_->left().subframes(), 8);
}

TEST_F(accumulation, rays_of_the_cpu_are_refined_in_squares) {
    session_->settings.renderer = WindowRenderer::splat;
    session_->settings.subframes = 16;
    rest();
    EXPECT_EQ(session_->left().subframes(), 16);
    // 4 x 4 rays: the mean of the picture with four times the pixels a side.
    const DepthImage fine =
        render_gl(random_gaussians(300, 0.01, 0.2, 41), session_->camera, 320, 240);
    const SumImage mean = shrunk({fine.width, fine.height, 1, fine.depth}, 4);
    const SumImage shown = session_->left().read();
    for (std::size_t n = 0; n < mean.value.size(); ++n)
        ASSERT_NEAR(shown.value[n], mean.value[n], 1e-5);
}

}  // namespace vog::test
