// command.h: fixture that runs the vog command in a temporary folder.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "support/data.h"
#include "vog/image.h"

namespace vog::test {

struct Result {
    int exit_code = -1;
    std::string out, error;
};

inline std::string read_text(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

class CommandLine : public testing::Test {
  protected:
    /// Runs `vog arguments` in the test's folder.
    /// before  text before the command, such as environment variables
    Result run(const std::string& arguments, const std::string& before = "") const {
        const std::string command = "cd '" + (dir_ / "").string() + "' && " + before + " '" +
                                    vog_command() + "' " + arguments +
                                    " >stdout.txt 2>stderr.txt </dev/null";
        const int status = std::system(command.c_str());
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(dir_ / "stdout.txt"),
                read_text(dir_ / "stderr.txt")};
    }
    /// Runs the command and expects success.
    Result must(const std::string& arguments, const std::string& before = "") const {
        const Result result = run(arguments, before);
        EXPECT_EQ(result.exit_code, 0) << "vog " << arguments << "\n" << result.error;
        return result;
    }
    /// Expects the exit code and one line on standard error that contains `text`.
    void must_fail(int exit_code, const std::string& arguments, const std::string& text,
                   const std::string& before = "") const {
        const Result result = run(arguments, before);
        EXPECT_EQ(result.exit_code, exit_code) << "vog " << arguments << "\n" << result.error;
        EXPECT_NE(result.error.find(text), std::string::npos) << "vog " << arguments << "\n"
                                                              << result.error;
        if (exit_code == 1) {
            EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1)
                << result.error;
            EXPECT_EQ(result.out, "");
        }
    }
    /// Expects two pictures of equal pixels; how they were made may differ.
    void expect_same_pixels(const std::string& one, const std::string& other) const {
        EXPECT_EQ(read_image(dir_ / one).pixel, read_image(dir_ / other).pixel)
            << one << ", " << other;
    }
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(dir_ / name, std::ios::binary) << text;
    }

    TempDir dir_;
};

}  // namespace vog::test
