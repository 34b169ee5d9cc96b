// mpi_failure_test.cpp: failures of one rank: all ranks end, and the error is printed once.
#include <chrono>

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
    write("small.sh", "#!/bin/sh\nulimit -v 1000000\nexec \"$@\"\n");
    must_fail_mpi(1,
                  "-n 2 COMMAND render c.vdb -o c.png --size 64 : "
                  "-n 1 sh small.sh COMMAND render c.vdb -o c.png --size 16384",
                  "vog-mpi: out of memory (rank 2 of 3)");
}

/// Nodes that mount different folders under one name: parts of both would be half a model.
TEST_F(mpi_failure, ranks_that_read_different_files_under_one_name_are_refused) {
    must("sample cloud c.vdb --size 64");
    std::filesystem::create_directory(dir_ / "other");
    write("there.sh", "#!/bin/sh\ncd other\nexec \"$@\"\n");
    const auto both = [](const std::string& work) {
        return "-n 1 COMMAND " + work + " : -n 1 sh there.sh COMMAND " + work;
    };
    const std::string convert = "convert c.vdb -o m.ply --block 8";
    must("sample explosion other/c.vdb --size 64");
    must_fail_mpi(1, both(convert), "c.vdb: is another file on rank 1");
    must_fail_mpi(1, both("render c.vdb -o c.png --size 32"), "c.vdb: is another file on rank 1");
    // A copy with other times is the same file; one byte less of mass in its middle is not.
    std::filesystem::copy_file(dir_ / "c.vdb", dir_ / "other/c.vdb",
                               std::filesystem::copy_options::overwrite_existing);
    std::filesystem::last_write_time(
        dir_ / "other/c.vdb",
        std::filesystem::file_time_type::clock::now() - std::chrono::hours(1));
    const Result same = mpi(both(convert));
    EXPECT_EQ(same.exit_code, 0) << same.error;
    std::string bytes = read_text(dir_ / "c.vdb");
    bytes[bytes.size() / 2 + 1] ^= 1;
    write("other/c.vdb", bytes);
    must_fail_mpi(1, both(convert), "c.vdb: is another file on rank 1");
    write("p.xyz", "1 2 3\n2 3 4\n");
    write("other/p.xyz", "1 2 3\n2 3 5\n");
    must_fail_mpi(1, both("render p.xyz -o p.png --size 32"), "p.xyz: is another file on rank 1");
    must("convert c.vdb -o g.ply --block 8");
    must("convert c.vdb -o other/g.ply --block 4");
    must_fail_mpi(1, both("render g.ply -o g.png --size 32"), "g.ply: is another file on rank 1");
}

TEST_F(mpi_failure, outputs_that_cannot_be_written_keep_earlier_ones) {
    must("sample cloud c.vdb --size 64");
    write("m.ply", "earlier");
    write("small.sh", "#!/bin/sh\nulimit -f 1\nexec \"$@\"\n");
    must_fail_mpi(1, "-n 3 sh small.sh COMMAND convert c.vdb -o m.ply --block 4",
                  "m.ply: cannot write");
    EXPECT_EQ(read_text(dir_ / "m.ply"), "earlier");
    for (const auto& entry : std::filesystem::directory_iterator(dir_ / ""))
        EXPECT_FALSE(entry.path().filename().string().starts_with('.')) << entry.path();
    must_mpi(3, "convert c.vdb --block 4 -o " + std::string(251, 'n') + ".ply");
    // A name under which one rank has another folder.
    std::filesystem::create_directories(dir_ / "other/out");
    std::filesystem::create_directory(dir_ / "out");
    write("there.sh", "#!/bin/sh\nmount --bind other/out out && exec \"$@\"\n");
    if (std::system("unshare -m true 2>/dev/null") != 0)
        GTEST_SKIP() << "this system lets us mount no folder (root and unshare needed)";
    const std::string work = "COMMAND convert c.vdb -o out/m.ply --block 4";
    must_fail_mpi(1, "-n 1 " + work + " : -n 1 unshare -m sh there.sh " + work,
                  "out/m.ply: the folder of the first rank is not there");
}

}  // namespace vog::test
