// points_hdf5_test.cpp: particles of snapshots in HDF5, and packed text.
#include <gtest/gtest.h>

#ifdef VOG_HDF5
#include <hdf5.h>
#endif

#include "io/scan/scan_files.h"
#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "vog/points.h"

namespace vog::test {

TEST(points_gzip, packed_text_reads_as_the_text) {
    const TempDir dir;
    const std::string text = "x,y,z,mass\n1,2,3,4\n5,6,7,8\n";
    write_bytes(dir / "p.csv", text);
    write_bytes(dir / "p.csv.gz", gzipped(text));
    const Points plain = read_points(dir / "p.csv"), packed = read_points(dir / "p.csv.gz");
    EXPECT_EQ(packed.position, plain.position);
    EXPECT_EQ(packed.attributes.at(0).name, "mass");
    const std::string cut = gzipped(text).substr(0, 30);
    write_bytes(dir / "cut.csv.gz", cut);
    EXPECT_NE(refusal([&] { read_points(dir / "cut.csv.gz"); }).find("truncated"),
              std::string::npos);
    write_bytes(dir / "no.csv.gz", text);
    EXPECT_NE(refusal([&] { read_points(dir / "no.csv.gz"); }).find("not gzip"), std::string::npos);
    EXPECT_NE(refusal([&] { write_points(dir / "new.csv.gz", plain); }).find("packed"),
              std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(dir / "new.csv.gz"));
}

#ifdef VOG_HDF5

namespace {

void put(hid_t group, const char* name, const std::vector<double>& values, hsize_t rows,
         hsize_t components) {
    const hsize_t size[2] = {rows, components};
    const hid_t space = H5Screate_simple(components > 1 ? 2 : 1, size, nullptr);
    const hid_t set =
        H5Dcreate2(group, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    H5Dclose(set);
    H5Sclose(space);
}

/// Two gas particles with density and velocities, whose mass is in the table; `dark`: a third type.
void write_snapshot(const std::filesystem::path& file, bool dark = false) {
    const hid_t handle = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t header = H5Gcreate2(handle, "Header", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    const double masses[6] = {0.25, 0, 0, 0, 0, 0};
    const hsize_t types = 6;
    const hid_t space = H5Screate_simple(1, &types, nullptr);
    const hid_t table =
        H5Acreate2(header, "MassTable", H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(table, H5T_NATIVE_DOUBLE, masses);
    H5Aclose(table);
    H5Sclose(space);
    H5Gclose(header);
    const hid_t gas = H5Gcreate2(handle, "PartType0", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put(gas, "Coordinates", {1, 2, 3, 4, 5, 6}, 2, 3);
    put(gas, "Velocities", {0, 0, 1, 3, 4, 0}, 2, 3);
    put(gas, "Density", {10, 20}, 2, 1);
    put(gas, "MagneticField", {3, 4, 0, 0, 0, 2}, 2, 3);
    H5Gclose(gas);
    if (dark) {
        const hid_t group = H5Gcreate2(handle, "PartType1", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        put(group, "Coordinates", {7, 8, 9}, 1, 3);
        put(group, "Masses", {5}, 1, 1);
        H5Gclose(group);
    }
    H5Fclose(handle);
}

}  // namespace

TEST(points_hdf5, snapshot_has_positions_velocities_and_attributes) {
    const TempDir dir;
    write_snapshot(dir / "s.hdf5");
    const Points points = read_points(dir / "s.hdf5");
    ASSERT_EQ(points.size(), 2u);
    EXPECT_EQ(points.position[1], (Vec3d{4, 5, 6}));
    EXPECT_EQ(points.velocity[1], (Vec3f{3, 4, 0}));
    EXPECT_EQ(point_values(points, "Density")[1], 20);
    EXPECT_EQ(point_values(points, "MagneticField")[0], 5) << "vectors by length";
    EXPECT_EQ(point_values(points, "Masses")[0], 0.25f) << "from the table";
}

TEST(points_hdf5, one_of_several_types_is_named) {
    const TempDir dir;
    write_snapshot(dir / "s.hdf5", true);
    EXPECT_NE(refusal([&] { read_points(dir / "s.hdf5"); }).find("PartType0, PartType1"),
              std::string::npos);
    const Points points = read_points(dir / "s.hdf5", {.grid = "PartType1"});
    EXPECT_EQ(points.position.at(0), (Vec3d{7, 8, 9}));
    EXPECT_EQ(point_values(points, "Masses")[0], 5);
}

TEST(points_hdf5, columns_are_of_text_files_alone) {
    const TempDir dir;
    write_snapshot(dir / "s.hdf5");
    write_points(dir / "s.vdb", read_points(dir / "s.hdf5"));
    for (const char* name : {"s.hdf5", "s.vdb"})
        EXPECT_NE(refusal([&] {
                      read_points(dir / name, {.columns = {"x", "y", "z"}});
                  }).find("columns are of text files"),
                  std::string::npos)
            << name;
}

TEST(points_hdf5, foreign_and_truncated_files_are_refused_in_silence) {
    const TempDir dir;
    write_snapshot(dir / "s.hdf5");
    const std::string bytes = [&] {
        std::ifstream in(dir / "s.hdf5", std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(in), {});
    }();
    testing::internal::CaptureStderr();
    for (std::size_t size = 0; size < bytes.size(); size += 97) {
        write_bytes(dir / "cut.hdf5", bytes.substr(0, size));
        const std::string message = refusal([&] { read_points(dir / "cut.hdf5"); });
        EXPECT_NE(message.find("cut.hdf5"), std::string::npos) << size << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

#endif

}  // namespace vog::test
