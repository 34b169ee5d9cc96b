// fault_command.h: fixture for commands whose writing fails: earlier outputs must survive.
#pragma once

#include <fmt/core.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <map>
#include <thread>

#include "support/command.h"
#include "vog/convert_moments.h"
#include "vog/image.h"
#include "vog/ply.h"
#include "vog/sample.h"
#include "vog/volume_io.h"

#ifdef VOG_SANITIZE
#define VOG_NEEDS_PRELOAD() \
    GTEST_SKIP() << "the sanitizers must be loaded before every other library"
#else
#define VOG_NEEDS_PRELOAD() (void)0
#endif

namespace vog::test {

/// A command and the files that it writes below out/.
struct Job {
    std::string arguments;
    std::vector<std::string> outputs;
};

class Faults : public CommandLine {
  protected:
    void SetUp() override {
#ifdef VOG_SANITIZE
        // Commands count the lines of device code that they run in files, which a test's faults would damage, and say so:
        // those of this test are its own, and say nothing.
        ::setenv("GCOV_PREFIX", (dir_ / "counted").c_str(), 1);
        ::setenv("GCOV_ERROR_FILE", "/dev/null", 1);
#endif
        std::filesystem::create_directory(dir_ / "out");
        const Volume cloud = sample_cloud({.size = 64});
        write_vdb(dir_ / "c.vdb", cloud);
        write_ply(dir_ / "m.ply", convert_moments(cloud, {.block_voxels = 8, .soft_steps = 0}));
        DepthImage a(64, 64), b(64, 64);
        for (std::size_t n = 0; n < a.depth.size(); ++n) a.depth[n] = 0.001f * float(n % 1000);
        write_exr(dir_ / "a.exr", a);
        write_exr(dir_ / "b.exr", b);
    }
    void TearDown() override {
        for (const char* name : {"GCOV_PREFIX", "GCOV_ERROR_FILE"}) ::unsetenv(name);
    }
    /// Every command, every format.
    static std::vector<Job> jobs() {
        return {{"convert c.vdb -o out/m.ply --block 8 --set soft-steps=0", {"m.ply"}},
                {"render c.vdb --size 64 -o out/p.png --depth-out out/t.exr --show column "
                 "--values-out out/v.npy",
                 {"p.png", "t.exr", "v.npy"}},
                {"sample cloud out/s.vdb --size 64", {"s.vdb"}},
                {"sample particles out/x.xyz --size 8", {"x.xyz"}},
                {"page m.ply -o out/e.html", {"e.html"}},
                {"compare a.exr b.exr --diff out/d.png", {"d.png"}}};
    }
    std::string output(const std::string& name) const { return read_text(dir_ / ("out/" + name)); }
    /// The files of a job as a run without faults writes them.
    std::map<std::string, std::string> expected(const Job& job) const {
        must(job.arguments);
        std::map<std::string, std::string> files;
        for (const std::string& name : job.outputs) {
            files[name] = output(name);
            EXPECT_GT(files[name].size(), 50u) << name;
        }
        return files;
    }
    /// Earlier outputs in place of a job's.
    void write_old(const Job& job) const {
        for (const std::string& name : job.outputs) write("out/" + name, "earlier " + name);
    }
    std::vector<std::string> hidden_files() const {
        std::vector<std::string> names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(dir_ / "out"))
            if (entry.path().filename().string().starts_with('.')) names.push_back(entry.path());
        return names;
    }
    /// Expects every file of a job to be the earlier or the whole new one, with no other beside;
    /// after exit code 0 the new one, else one line on standard error.
    void expect_whole(const Job& job, const std::map<std::string, std::string>& files,
                      const Result& result, const std::string& about) const {
        int old = 0;
        for (const auto& [name, bytes] : files) {
            const std::string now = output(name);
            old += now == "earlier " + name;
            EXPECT_TRUE(now == bytes || now == "earlier " + name)
                << about << ": " << name << " has " << now.size() << " bytes";
        }
        EXPECT_EQ(hidden_files(), std::vector<std::string>{}) << about;
        if (result.exit_code == 0) {
            EXPECT_EQ(old, 0) << about << ": " << job.arguments;
            return;
        }
        EXPECT_EQ(result.exit_code, 1) << about << "\n" << result.error;
        EXPECT_TRUE(result.error.starts_with("vog: ")) << about << "\n" << result.error;
        EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1) << about << "\n"
                                                                                 << result.error;
    }

    /// Runs a job over earlier files with one failing call: a full disk; expects whole files.
    /// call     number of the call that fails, from 1
    /// returns  whether the job failed, naming the full disk
    bool fails_whole(const Job& job, const std::map<std::string, std::string>& files,
                     int call) const {
        write_old(job);
        const Result result = run(job.arguments, fault(call, ENOSPC));
        const std::string about = fmt::format("call {}, {}", call, read_text(dir_ / "mark"));
        expect_whole(job, files, result, about);
        if (result.exit_code == 0) return false;
        EXPECT_NE(result.error.find("No space left on device"), std::string::npos) << about << "\n"
                                                                                   << result.error;
        return true;
    }

    /// Starts `vog arguments` in the test's folder, in a process group of its own.
    /// program  path of the command
    pid_t start(const std::string& arguments, const std::string& before = "") const {
        return start_shell(before + " '" + vog_command() + "' " + arguments);
    }
    pid_t start_shell(const std::string& command) const {
        const std::string all = "cd '" + (dir_ / "").string() + "' && exec env " + command +
                                " >stdout.txt 2>stderr.txt </dev/null";
        const pid_t process = ::fork();
        if (process == 0) {
            ::setpgid(0, 0);
            ::execl("/bin/sh", "sh", "-c", all.c_str(), nullptr);
            ::_exit(127);
        }
        return process;
    }
    static int wait_status(pid_t process) {
        int status = 0;
        ::waitpid(process, &status, 0);
        return status;
    }
    /// Variables that make a call below out/ fail, or wait where `error` is 0.
    std::string fault(int call, int error) const {
        return fmt::format(
            "LD_PRELOAD='{}' VOG_FAULT_FOLDER=out/ VOG_FAULT_CALL={} VOG_FAULT_ERROR={} "
            "VOG_FAULT_MARK='{}'",
            fail_calls(), call, error, (dir_ / "mark").string());
    }
    static std::string fail_calls() { return VOG_FAIL_CALLS; }
    /// Number of calls that a job makes below out/.
    int count_calls(const Job& job) const {
        must(job.arguments, fault(0, 0));
        return std::stoi("0" + read_text(dir_ / "mark"));
    }
};

}  // namespace vog::test
