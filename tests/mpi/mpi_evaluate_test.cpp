// mpi_evaluate_test.cpp: vog-mpi evaluate gives the figures of vog evaluate.
#include <nlohmann/json.hpp>

#include "mpi_command.h"

namespace vog::test {

class mpi_evaluate : public Mpi {};

TEST_F(mpi_evaluate, rows_have_the_figures_of_one_process) {
    must("sample cloud c.vdb --size 64");
    const std::string arguments = "evaluate c.vdb --size 64 --repeat 1 --json -o ";
    const auto one = nlohmann::json::parse(must(arguments + "one").out);
    const auto many = nlohmann::json::parse(must_mpi(3, arguments + "many").out);
    for (const char* count :
         {"active_voxels", "bounding_voxels", "leaves", "dense_leaves", "tiles"})
        EXPECT_EQ(one["data"][count], many["data"][count]) << count;
    std::size_t compared = 0;
    for (const auto& row : many["rows"])
        for (const auto& other : one["rows"]) {
            if (row["series"] != other["series"] || row["step"] != other["step"]) continue;
            ++compared;
            EXPECT_EQ(row["gaussians"], other["gaussians"]) << row["series"] << row["step"];
            EXPECT_EQ(row["bytes"], other["bytes"]);
            for (std::size_t view = 0; view < row["views"].size(); ++view) {
                const double a = row["views"][view]["relative_l2"];
                const double b = other["views"][view]["relative_l2"];
                EXPECT_NEAR(a, b, 1e-4 * b) << row["series"] << row["step"] << view;
            }
        }
    EXPECT_EQ(compared, many["rows"].size());
    EXPECT_EQ(compared, 20u);  // 16 of the paper, 4 uniform
    EXPECT_TRUE(std::filesystem::exists(dir_ / "many" / "results.csv"));
}

TEST_F(mpi_evaluate, the_error_of_the_field_is_of_one_process) {
    must("sample cloud c.vdb --size 64");
    must_fail_mpi(2, "-n 2 COMMAND evaluate c.vdb -o out --voxels",
                  "--voxels has no effect with vog-mpi; use vog evaluate");
}

}  // namespace vog::test
