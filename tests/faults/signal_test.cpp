// signal_test.cpp: commands ended by signals while they write, and killed at random moments: no
// temporary file stays where the signal can be handled, and no output is ever half.
#include <nlohmann/json.hpp>
#include <random>

#include "fault_command.h"

namespace vog::test {

class signals : public Faults {
  protected:
    /// Waits until the command has made the call at which it stops; false after 20 s, or when it
    /// ended before.
    bool wait_for_mark(pid_t process) const {
        for (int n = 0; n < 2000; ++n) {
            if (std::filesystem::exists(dir_ / "mark")) return true;
            if (::waitpid(process, nullptr, WNOHANG) != 0) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
    /// Starts a command and kills it after a random part of `longest`.
    void kill_at_random(const std::string& arguments, std::chrono::duration<double> longest) {
        const pid_t process = start(arguments);
        std::uniform_real_distribution<double> part(0, 1);
        std::this_thread::sleep_for(longest * part(random_));
        ::kill(-process, SIGKILL);
        wait_status(process);
    }
    std::chrono::duration<double> time_of(const std::string& arguments) const {
        const auto start = std::chrono::steady_clock::now();
        must(arguments);
        return std::chrono::steady_clock::now() - start;
    }
    void copy_input(const std::string& name) const {
        std::filesystem::copy_file(dir_ / "c.vdb", dir_ / name);
        // Older than every model, whatever the resolution of times on this disk.
        std::filesystem::last_write_time(
            dir_ / name, std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
    }

    std::mt19937 random_{20260601};
};

TEST_F(signals, that_end_a_command_remove_its_temporary_files) {
    VOG_NEEDS_PRELOAD();
    for (const Job& job : jobs()) {
        const auto files = expected(job);
        // Waits in its last call but one or so: the temporary file is there.
        const int calls = count_calls(job);
        for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
            write_old(job);
            std::filesystem::remove(dir_ / "mark");
            const pid_t process = start(job.arguments, fault(calls - 1, 0));
            ASSERT_TRUE(wait_for_mark(process)) << job.arguments;
            EXPECT_EQ(hidden_files().size(), 1u) << job.arguments;
            ::kill(process, number);
            const int status = wait_status(process);
            EXPECT_TRUE(WIFSIGNALED(status) && WTERMSIG(status) == number)
                << job.arguments << ", signal " << number << ": status " << status;
            EXPECT_EQ(hidden_files(), std::vector<std::string>{}) << job.arguments;
            for (const auto& [name, bytes] : files) {
                const std::string now = output(name);
                EXPECT_TRUE(now == bytes || now == "earlier " + name) << name;
            }
        }
    }
}

TEST_F(signals, that_are_ignored_stay_ignored) {
    VOG_NEEDS_PRELOAD();
    const Job job = jobs().front();
    const int calls = count_calls(job);
    std::filesystem::remove(dir_ / "mark");
    // As nohup starts commands.
    const pid_t process = start_shell("sh -c 'trap \"\" HUP; exec env " + fault(calls - 1, 0) +
                                      " " + vog_command() + " " + job.arguments + "'");
    ASSERT_TRUE(wait_for_mark(process));
    ::kill(process, SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(::waitpid(process, nullptr, WNOHANG), 0);
    EXPECT_EQ(hidden_files().size(), 1u);
    ::kill(process, SIGTERM);
    EXPECT_EQ(WTERMSIG(wait_status(process)), SIGTERM);
    EXPECT_EQ(hidden_files().size(), 0u);
}

TEST_F(signals, kills_leave_earlier_outputs_or_whole_new_ones) {
    for (const Job& job : jobs()) {
        const auto files = expected(job);
        const auto whole_run = time_of(job.arguments);
        write_old(job);
        for (int n = 0; n < 5; ++n) {
            kill_at_random(job.arguments, 1.1 * whole_run);
            for (const auto& [name, bytes] : files) {
                const std::string now = output(name);
                EXPECT_TRUE(now == bytes || now == "earlier " + name)
                    << job.arguments << ": " << name << " has " << now.size() << " bytes";
            }
        }
        must(job.arguments);
        for (const auto& [name, bytes] : files) EXPECT_EQ(output(name), bytes) << name;
    }
}

TEST_F(signals, killed_sequences_go_on_where_they_were) {
    for (int n = 0; n < 6; ++n) copy_input(fmt::format("frame_{}.vdb", n));
    const std::string sequence = "convert 'frame_*.vdb' -o out/models/ --block 2 --threads 1";
    const auto whole_run = time_of(sequence + " --again");
    std::map<std::string, std::string> models;
    for (int n = 0; n < 6; ++n) {
        const std::string name = fmt::format("frame_{}.ply", n);
        models[name] = output("models/" + name);
    }
    for (int round = 0; round < 3; ++round) {
        std::filesystem::remove_all(dir_ / "out/models");
        for (int n = 0; n < 3; ++n) {
            kill_at_random(sequence, 0.6 * whole_run);
            for (const auto& [name, model] : models) {
                const std::string now = output("models/" + name);
                EXPECT_TRUE(now.empty() || now == model) << name << ": " << now.size() << " bytes";
            }
        }
        must(sequence);
        for (const auto& [name, model] : models)
            EXPECT_TRUE(output("models/" + name) == model) << name;
    }
}

TEST_F(signals, killed_evaluations_are_resumed) {
    Volume small = sample_cloud({.size = 64});
    small.leaves.resize(small.leaves.size() / 6);
    write_vdb(dir_ / "small.vdb", small);
    const std::string evaluation =
        "evaluate small.vdb -o out/e --size 16 --repeat 1 --threads 2 --resume --json";
    const auto whole_run = time_of(evaluation);
    const auto rows_of = [](const std::string& text) {
        return nlohmann::json::parse(text)["rows"].size();
    };
    const std::size_t all = rows_of(output("e/results.json"));
    std::filesystem::remove_all(dir_ / "out/e");
    std::size_t kept = 0;
    for (int n = 0; n < 2; ++n) {
        kill_at_random(evaluation, 0.6 * whole_run);
        if (!std::filesystem::exists(dir_ / "out/e/results.json")) continue;
        const std::size_t rows = rows_of(output("e/results.json"));
        EXPECT_GE(rows, kept) << "finished conversions were lost";
        kept = rows;
    }
    EXPECT_EQ(rows_of(must(evaluation).out), all);
}

/// What a system that stopped may leave: nothing of it is a model.
TEST_F(signals, sequences_convert_damaged_models_again) {
    copy_input("frame_1.vdb");
    const std::string sequence = "convert frame_1.vdb -o out/models/ --block 8 --json";
    const auto there_already = [&] {
        return nlohmann::json::parse(must(sequence).out)["there_already"].get<int>();
    };
    EXPECT_EQ(there_already(), 0);
    EXPECT_EQ(there_already(), 1);
    const std::string model = output("models/frame_1.ply");
    for (const std::string& damaged :
         {std::string(), model.substr(0, 100), model.substr(0, model.size() - 1), model + "x",
          std::string(model.size(), '\0')}) {
        write("out/models/frame_1.ply", damaged);
        EXPECT_EQ(there_already(), 0) << damaged.size() << " bytes";
        EXPECT_TRUE(output("models/frame_1.ply") == model);
    }
}

TEST_F(signals, damaged_results_of_an_evaluation_are_one_clear_line) {
    std::filesystem::create_directory(dir_ / "out/e");
    const std::string evaluation = "evaluate c.vdb -o out/e --size 16 --repeat 1 --resume";
    for (const std::string text : {"", "{\"format\": \"vog", "[]", "{}", "{\"format\": 7}"}) {
        write("out/e/results.json", text);
        const Result result = run(evaluation);
        EXPECT_EQ(result.exit_code, 1) << text;
        EXPECT_TRUE(result.error.starts_with("vog: out/e/results.json: ")) << result.error;
        EXPECT_EQ(std::count(result.error.begin(), result.error.end(), '\n'), 1) << result.error;
        EXPECT_EQ(result.error.find("json.exception"), std::string::npos) << result.error;
        EXPECT_EQ(result.error.find("parse error"), std::string::npos) << result.error;
        EXPECT_EQ(output("e/results.json"), text);
    }
}

#ifdef VOG_MPI_COMMAND

/// The root writes under a hidden name; ranks write into it together.
TEST_F(signals, killed_mpi_runs_leave_earlier_outputs_or_whole_new_ones) {
    const std::string work = "OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 " VOG_MPIRUN
                             " --oversubscribe --bind-to none -n 2 '" VOG_MPI_COMMAND
                             "' convert c.vdb -o out/m.ply --block 2";
    const auto begin = std::chrono::steady_clock::now();
    ASSERT_EQ(wait_status(start_shell(work)), 0) << read_text(dir_ / "stderr.txt");
    const std::chrono::duration<double> whole_run = std::chrono::steady_clock::now() - begin;
    const std::string model = output("m.ply");
    write("out/m.ply", "earlier");
    std::uniform_real_distribution<double> part(0.3, 1);
    for (const int number : {SIGTERM, SIGKILL, SIGTERM}) {
        const pid_t process = start_shell(work);
        std::this_thread::sleep_for(whole_run * part(random_));
        ::kill(-process, number);
        wait_status(process);
        const std::string now = output("m.ply");
        EXPECT_TRUE(now == model || now == "earlier") << now.size() << " bytes";
        if (number == SIGTERM) {
            EXPECT_EQ(hidden_files(), std::vector<std::string>{});
        }
        for (const std::string& name : hidden_files()) std::filesystem::remove(name);
    }
    ASSERT_EQ(wait_status(start_shell(work)), 0) << read_text(dir_ / "stderr.txt");
    EXPECT_TRUE(output("m.ply") == model);
}

#endif

}  // namespace vog::test
