// headless.h: fixture with a headless OpenGL context; tests skip, with a message, where there is
// none.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "screen/screen.h"
#include "vog/error.h"

namespace vog::test {

/// Fixture of the tests that need OpenGL.
class headless : public testing::Test {
  protected:
    void SetUp() override {
        try {
            screen_ = viewer::open_headless({64, 64});
        } catch (const Error& error) {
            GTEST_SKIP() << "no OpenGL 3.3 on this machine: " << error.what();
        }
    }
    std::unique_ptr<viewer::Screen> screen_;
};

}  // namespace vog::test
