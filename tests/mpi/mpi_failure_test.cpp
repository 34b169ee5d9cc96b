// mpi_failure_test.cpp: failures of one rank: all ranks end, and the error is printed once.
#include "mpi_command.h"

namespace vog::test {

class mpi_failure : public Mpi {};

TEST_F(mpi_failure, file_that_one_rank_lacks_ends_all) {
    must("sample cloud c.vdb --size 64");
    must_fail_mpi(1,
                  "-n 2 COMMAND render c.vdb -o c.png --size 32 : -n 1 COMMAND render no.vdb -o "
                  "c.png --size 32",
                  "vog-mpi: no.vdb: no such file (rank 2 of 3)");
    EXPECT_FALSE(std::filesystem::exists(dir_ / "c.png"));
    must_fail_mpi(1, "-n 3 COMMAND render no.vdb -o c.png", "vog-mpi: no.vdb: no such file\n");
}

TEST_F(mpi_failure, damage_in_one_part_ends_all) {
    must("sample cloud c.vdb --size 64");
    std::string bytes = read_text(dir_ / "c.vdb");
    // The leaves of one rank lie near the end: these bytes do not decompress, or are not finite.
    for (std::size_t n = bytes.size() - 600; n < bytes.size() - 200; ++n) bytes[n] = '\xff';
    write("bad.vdb", bytes);
    must_fail_mpi(1, "-n 3 COMMAND render bad.vdb -o c.png --size 32", "bad.vdb");
}

TEST_F(mpi_failure, picture_that_cannot_be_written_ends_all) {
    must("sample cloud c.vdb --size 64");
    must_fail_mpi(1, "-n 2 COMMAND render c.vdb -o nowhere/c.png", "no folder 'nowhere'");
}

TEST_F(mpi_failure, wrong_usage_is_reported_once) {
    must_fail_mpi(2, "-n 3 COMMAND render c.vdb -o c.png --size none", "--size");
    must_fail_mpi(2, "-n 2 COMMAND", "subcommand");
}

/// A killed rank reports nothing: mpirun ends the others. The work would take hours, and the kill
/// may come at any point of it.
TEST_F(mpi_failure, killed_rank_ends_all) {
    must("sample cloud c.vdb --size 64");
    const std::string work = "COMMAND render c.vdb --size 512 --repeat 100000 --threads 1";
    write("killed.sh", "#!/bin/sh\n\"$@\" &\nsleep 2\nkill -9 $!\nwait $!\n");
    const Result result = mpi("-n 2 " + work + " : -n 1 sh killed.sh " + work);
    EXPECT_NE(result.exit_code, 0);
    EXPECT_NE(result.exit_code, 124) << "still waiting after two minutes";
}

/// A picture of 14 GB on a rank with an address space of 6 GB.
TEST_F(mpi_failure, lack_of_memory_on_one_rank_ends_all) {
    must("sample cloud c.vdb --size 64");
    write("small.sh", "#!/bin/sh\nulimit -v 6000000\nexec \"$@\"\n");
    must_fail_mpi(1,
                  "-n 2 COMMAND render c.vdb -o c.png --size 64 : "
                  "-n 1 sh small.sh COMMAND render c.vdb -o c.png --size 60000",
                  "vog-mpi: out of memory (rank 2 of 3)");
}

}  // namespace vog::test
