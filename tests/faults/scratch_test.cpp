// scratch_test.cpp: scratch files of --memory that cannot be made or grow no further.
#include "fault_command.h"

namespace vog::test {

class scratch_faults : public Faults {
  protected:
    void SetUp() override {
        std::filesystem::create_directories(dir_ / "out/scratch");
        // Positions of 6 MB: arrays from 4 MB on lie in scratch files.
        must("sample particles p.xyz --size 64");
    }
};

TEST_F(scratch_faults, full_scratch_folder_keeps_earlier_outputs) {
    VOG_NEEDS_PRELOAD();
    const Job job{"convert p.xyz -o out/p.csv --memory 64M --set scratch=out/scratch", {"p.csv"}};
    const Result probe = run(job.arguments);
    if (probe.error.find("tmpfs") != std::string::npos)
        GTEST_SKIP() << "temporary folders of this system lie in memory: " << probe.error;
    const auto files = expected(job);
    const int calls = count_calls(job);
    ASSERT_GE(calls, 8) << "no scratch files are made";
    int failures = 0;
    for (int call = 1; call <= calls; call += 1 + calls / 6) {
        failures += fails_whole(job, files, call);
        EXPECT_TRUE(std::filesystem::is_empty(dir_ / "out/scratch")) << "call " << call;
    }
    EXPECT_GE(failures, 3);
}

TEST_F(scratch_faults, missing_folders_are_one_clear_line) {
    must_fail(1, "convert p.xyz -o out/p.ply --memory 64M",
              "TMPDIR=/nosuch: this folder for scratch files does not exist", "TMPDIR=/nosuch");
    must_fail(1, "convert p.xyz -o out/p.ply --memory 64M --set scratch=nosuch",
              "nosuch: cannot make a scratch file here: No such file or directory");
}

}  // namespace vog::test
