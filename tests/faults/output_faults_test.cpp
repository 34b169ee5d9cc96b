// output_faults_test.cpp: outputs that cannot be written: every call of the system failing in turn,
// limits, full disks, folders without write access, standard output.
#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "fault_command.h"

namespace vog::test {

class output_faults : public Faults {};

TEST_F(output_faults, each_failing_call_of_the_system_keeps_earlier_outputs) {
    VOG_NEEDS_PRELOAD();
    for (const Job& job : jobs()) {
        const auto files = expected(job);
        const int calls = count_calls(job);
        ASSERT_GE(calls, 4) << job.arguments << ": the faults do not reach the command";
        // The first calls, the last ones, and some between: writes in the middle are alike.
        int failures = 0, synced = 0;
        constexpr int kFirst = 5, kLast = 4, kBetween = 3;
        for (int call = 1; call <= calls;) {
            failures += fails_whole(job, files, call);
            synced += read_text(dir_ / "mark") == "fsync";
            const int left = calls - kLast - call;  // calls up to the last ones
            call += call < kFirst || left <= 1 ? 1 : std::min(left, calls / (kBetween + 1) + 1);
        }
        EXPECT_GE(synced, 1) << job.arguments << ": renamed before the disk has the bytes";
        EXPECT_GE(failures, 3) << job.arguments;
        // The failures leave nothing that hinders the next run.
        write_old(job);
        expect_whole(job, files, must(job.arguments), "after the failures");
    }
}

TEST_F(output_faults, other_reasons_are_named_as_they_are) {
    VOG_NEEDS_PRELOAD();
    const Job job = jobs().front();
    const auto files = expected(job);
    for (const auto& [error, text] : {std::pair{EDQUOT, "Disk quota exceeded"},
                                      {EIO, "Input/output error"},
                                      {EROFS, "Read-only file system"}}) {
        write_old(job);
        const Result result = run(job.arguments, fault(1, error));
        expect_whole(job, files, result, text);
        EXPECT_NE(result.error.find(std::string("out/m.ply: cannot write: ") + text),
                  std::string::npos)
            << result.error;
    }
}

TEST_F(output_faults, files_beyond_the_system_limit_are_an_error) {
    for (const Job& job : jobs()) {
        const auto files = expected(job);
        write_old(job);
        // 512 bytes: larger than the earlier files, smaller than most new ones.
        const Result result = run(job.arguments, "ulimit -f 1; ");
        expect_whole(job, files, result, "ulimit -f 1: " + job.arguments);
        EXPECT_EQ(result.exit_code, 1) << job.arguments;
        EXPECT_NE(result.error.find("File too large"), std::string::npos) << result.error;
    }
}

/// A file system of 200 kB in memory, in a name space of mounts that ends with the shell.
TEST_F(output_faults, full_disk_keeps_earlier_outputs) {
    write("mount.sh", "mount -t tmpfs -o size=200k none out\n");
    if (std::system(
            ("cd '" + (dir_ / "").string() + "' && unshare -m sh mount.sh 2>/dev/null").c_str()))
        GTEST_SKIP() << "this system lets us mount no file system (root and unshare needed)";
    for (const Job& job : jobs()) {
        write("full.sh", fmt::format("set -e\nmount -t tmpfs -o size=200k none out\n"
                                     "for f in {0}; do echo earlier > out/$f; done\n"
                                     "dd if=/dev/zero of=out/rest bs=4k 2>/dev/null || true\n"
                                     "'{1}' {2} >stdout.txt 2>stderr.txt </dev/null && exit 99\n"
                                     "test $(ls -A out | wc -l) = {3}\n"
                                     "for f in {0}; do test \"$(cat out/$f)\" = earlier; done\n",
                                     fmt::join(job.outputs, " "), vog_command(), job.arguments,
                                     job.outputs.size() + 1));
        const int status =
            std::system(("cd '" + (dir_ / "").string() + "' && unshare -m sh full.sh").c_str());
        EXPECT_EQ(WEXITSTATUS(status), 0) << job.arguments;
        const std::string error = read_text(dir_ / "stderr.txt");
        EXPECT_NE(error.find("No space left on device"), std::string::npos) << error;
        EXPECT_EQ(std::count(error.begin(), error.end(), '\n'), 1) << error;
    }
}

TEST_F(output_faults, folder_without_write_access_is_reported_before_any_work) {
    namespace fs = std::filesystem;
    std::string user;
    if (::geteuid() == 0) {
        // Root may write everywhere: the command runs as the user nobody.
        user = "setpriv --reuid=65534 --regid=65534 --clear-groups";
        const std::string probe = user + " test -x '" + vog_command() + "' 2>/dev/null";
        if (std::system(probe.c_str()) != 0)
            GTEST_SKIP() << "no other user can run " << vog_command() << " here";
        fs::permissions(dir_ / "", fs::perms(0755));
        for (const char* file : {"stdout.txt", "stderr.txt"}) fs::remove(dir_ / file);
    }
    for (const Job& job : jobs()) {
        write_old(job);
        fs::permissions(dir_ / "out", fs::perms(0555));
        const Result result = run(job.arguments, user);
        EXPECT_EQ(result.exit_code, 1) << job.arguments;
        EXPECT_NE(result.error.find("cannot write: Permission denied"), std::string::npos)
            << job.arguments << "\n"
            << result.error;
        for (const std::string& name : job.outputs) EXPECT_EQ(output(name), "earlier " + name);
        fs::permissions(dir_ / "out", fs::perms(0755));
    }
}

TEST_F(output_faults, standard_output_that_takes_nothing_is_an_error) {
    const std::string vog = "'" + vog_command() + "'";
    for (const std::string command :
         {"info c.vdb", "info c.vdb --json", "info m.ply", "convert c.vdb -o out/m.ply --block 8",
          "convert c.vdb -o out/m.ply --block 8 --json",
          "render m.ply -o out/p.png --size 32 --json", "compare a.exr b.exr",
          "compare a.exr b.exr --json", "page m.ply -o out/e.html --json",
          "sample cloud out/c.vdb --size 64", "--help", "render --help", "--version"})
        for (const auto& [where, why] :
             {std::pair{">/dev/full", "No space left on device"}, {">&-", "Bad file descriptor"}}) {
            const std::string all = "cd '" + (dir_ / "").string() + "' && " + vog + " " + command +
                                    " 2>stderr.txt </dev/null " + where;
            EXPECT_EQ(WEXITSTATUS(std::system(all.c_str())), 1) << command << " " << where;
            EXPECT_EQ(read_text(dir_ / "stderr.txt"),
                      fmt::format("vog: standard output: cannot write: {}\n", why))
                << command << " " << where;
        }
    // A file opened by the command must not become its standard output.
    const std::string model = output("m.ply");
    must("convert c.vdb -o out/m.ply --block 8");
    EXPECT_TRUE(output("m.ply") == model);
}

TEST_F(output_faults, closed_standard_error_harms_no_output) {
    const std::string all = "cd '" + (dir_ / "").string() + "' && '" + vog_command() +
                            "' convert c.vdb -o out/m.ply --block 8 --verbose >/dev/null 2>&-";
    EXPECT_EQ(WEXITSTATUS(std::system(all.c_str())), 0);
    const std::string model = output("m.ply");
    must("convert c.vdb -o out/m.ply --block 8");
    EXPECT_TRUE(output("m.ply") == model);
    const std::string missing = "'" + vog_command() + "' info nosuch.vdb >/dev/null 2>&-";
    EXPECT_EQ(WEXITSTATUS(std::system(missing.c_str())), 1);
}

TEST_F(output_faults, a_closed_pipe_ends_the_command_as_other_tools) {
    const std::string all = "cd '" + (dir_ / "").string() + "' && (sleep 0.3; '" + vog_command() +
                            "' info c.vdb 2>stderr.txt; echo $? >status.txt) | true; wait; "
                            "while ! test -s status.txt; do sleep 0.05; done";
    EXPECT_EQ(std::system(all.c_str()), 0);
    EXPECT_EQ(read_text(dir_ / "status.txt"), fmt::format("{}\n", 128 + SIGPIPE));
    EXPECT_EQ(read_text(dir_ / "stderr.txt"), "");
}

TEST_F(output_faults, the_longest_names_of_a_folder_are_written) {
    const std::string longest(255 - 4, 'n');
    const std::string convert = "convert c.vdb --block 8 -o out/";
    must(convert + longest + ".ply");
    EXPECT_GT(output(longest + ".ply").size(), 1000u);
    must_fail(1, convert + longest + "n.ply", "cannot write: File name too long");
}

TEST_F(output_faults, two_outputs_are_never_one_file) {
    std::filesystem::create_symlink("t.exr", dir_ / "link.exr");
    for (const std::string outputs : {"-o t.exr --depth-out t.exr", "-o t.exr --depth-out ./t.exr",
                                      "-o t.exr --depth-out out/../t.exr",
                                      "--depth-out t.exr --show column --values-out t.exr"})
        must_fail(1, "render m.ply --size 32 " + outputs, "would be written twice");
    write("t.exr", "earlier");
    must_fail(1, "render m.ply --size 32 -o t.exr --depth-out link.exr", "would be written twice");
    EXPECT_EQ(read_text(dir_ / "t.exr"), "earlier");
    must("render m.ply --size 32 -o c.png");
    must_fail(1, "render m.ply --size 32 -o out/../c.png --camera c.png", "is also an input");
    must("render m.ply --size 32 -o a.png");
    must_fail(1, "compare a.png c.png --diff ./c.png", "is also an input");
    must_fail(1, "convert m.ply -o ./m.ply", "is also an input");
    // Folders may be one: their files have different names.
    must("render m.ply -o pictures/ --depth-out pictures/ --size 32");
}

/// JSON is UTF-8, names of files are any bytes.
TEST_F(output_faults, names_that_are_no_utf8_give_valid_json) {
    const std::string name = "out/\xff\xfe";
    for (const std::string& command :
         {"convert c.vdb --block 8 --json -o $'" + name + ".ply'",
          "render m.ply --size 32 --json -o $'" + name + ".png'", "info --json $'" + name + ".ply'",
          "page m.ply --json -o $'" + name + ".html'",
          "page $'" + name + ".ply' --json -o out/page.html",
          "compare --json a.exr b.exr --diff $'" + name + ".png'",
          "convert c.vdb --block 8 --json -o $'" + name + "/'",
          "render $'" + name + ".ply' --size 32 --json -o pictures/"}) {
        write("run.sh", "'" + vog_command() + "' " + command + " >stdout.txt 2>stderr.txt\n");
        const std::string all = "cd '" + (dir_ / "").string() + "' && bash run.sh";
        EXPECT_EQ(WEXITSTATUS(std::system(all.c_str())), 0) << command << "\n"
                                                            << read_text(dir_ / "stderr.txt");
        const std::string text = read_text(dir_ / "stdout.txt");
        EXPECT_FALSE(nlohmann::json::parse(text, nullptr, false).is_discarded()) << command;
    }
}

}  // namespace vog::test
