// readme_test.cpp: every snippet of the README runs: command lines here, C++ in tests/consumer.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "support/data.h"

namespace vog::test {

namespace {

std::string source_text(const std::string& file) {
    std::ifstream in(test::source_dir() / file);
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

/// Contents of the fenced code blocks of one language.
std::vector<std::string> blocks(const std::string& markdown, const std::string& language) {
    std::vector<std::string> all;
    const std::string fence = "```" + language + "\n";
    for (std::size_t at = markdown.find(fence); at != std::string::npos;
         at = markdown.find(fence, at)) {
        const std::size_t begin = at + fence.size(), end = markdown.find("```", begin);
        all.push_back(markdown.substr(begin, end - begin));
        at = end;
    }
    return all;
}

}  // namespace

TEST(readme, every_command_line_runs) {
    const TempDir dir;
    std::filesystem::create_symlink(test::vog_command(), dir / "vog");
    int commands = 0;
    for (const std::string& block : blocks(source_text("README.md"), "sh")) {
        std::istringstream lines(block);
        for (std::string line; std::getline(lines, line); ++commands) {
            const std::string command =
                "cd '" + (dir / "").string() + "' && PATH=.:$PATH && " + line;
            EXPECT_EQ(std::system((command + " >/dev/null").c_str()), 0) << line;
        }
    }
    EXPECT_GE(commands, 5);
}

TEST(readme, its_cpp_is_what_the_consumer_builds) {
    const std::string consumer = source_text("tests/consumer/consumer.cpp");
    const auto snippets = blocks(source_text("README.md"), "cpp");
    ASSERT_FALSE(snippets.empty());
    for (const std::string& snippet : snippets)
        EXPECT_NE(consumer.find(snippet), std::string::npos) << snippet;
}

}  // namespace vog::test
