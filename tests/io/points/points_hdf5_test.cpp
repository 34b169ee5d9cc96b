// points_hdf5_test.cpp: particles of snapshots in HDF5, and packed text.
#include <gtest/gtest.h>

#ifdef VOG_HDF5
#include <hdf5.h>
#endif

#include <map>
#include <optional>
#include <span>

#include "io/points/snapshot_units.h"
#include "io/scan/scan_files.h"
#include "support/data.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/model_io.h"
#include "vog/picture.h"
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

/// Numbers of the head of a snapshot: by name, one each type, or one.
using Head = std::vector<std::pair<const char*, std::vector<double>>>;
void put_head(hid_t file, const Head& head) {
    const hid_t header = H5Gcreate2(file, "Header", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    for (const auto& [name, numbers] : head) {
        const hsize_t count = numbers.size();
        const hid_t space =
            count > 1 ? H5Screate_simple(1, &count, nullptr) : H5Screate(H5S_SCALAR);
        const hid_t table =
            H5Acreate2(header, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, H5P_DEFAULT);
        H5Awrite(table, H5T_NATIVE_DOUBLE, numbers.data());
        H5Aclose(table);
        H5Sclose(space);
    }
    H5Gclose(header);
}

/// Two gas particles with density and velocities, whose mass is in the table; `dark`: a third type.
void write_snapshot(const std::filesystem::path& file, bool dark = false) {
    const hid_t handle = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    put_head(handle, {{"MassTable", {0.25, 0, 0, 0, 0, 0}}});
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

TEST(points_hdf5, gas_is_meant_among_several_types_and_noted) {
    const TempDir dir;
    write_snapshot(dir / "s.hdf5", true);
    const std::filesystem::path file = dir / "s.hdf5";
    std::vector<std::string> notes;
    EXPECT_EQ(read_points(std::span(&file, 1), {}, &notes).size(), 2u);
    EXPECT_EQ(notes,
              std::vector<std::string>{
                  file.string() +
                  ": reading 'PartType0', one of 2 grids; --grid chooses another: PartType1"});
    EXPECT_EQ(read_points(file).size(), 2u);
    EXPECT_NE(refusal([&] {
                  read_points(file, {.refuse_several = true});
              }).find("choose one with --grid (it has: PartType0, PartType1)"),
              std::string::npos);
    const Points points = read_points(dir / "s.hdf5", {.grid = "PartType1"});
    EXPECT_EQ(points.position.at(0), (Vec3d{7, 8, 9}));
    EXPECT_EQ(point_values(points, "Masses")[0], 5);
}

TEST(points_hdf5, units_of_a_snapshot_convert_and_stay_with_the_model) {
    const TempDir dir;
    const hid_t handle =
        H5Fcreate((dir / "s.hdf5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    constexpr double kKpc = 3.085678e21, kMass = 1.989e43, kSpeed = 1e5, kHubble = 0.7,
                     kScale = 0.5;
    put_head(handle, {{"MassTable", {0.25, 0, 0, 0, 0, 0}},
                      {"UnitLength_in_cm", {kKpc}},
                      {"UnitMass_in_g", {kMass}},
                      {"UnitVelocity_in_cm_per_s", {kSpeed}},
                      {"HubbleParam", {kHubble}},
                      {"Redshift", {1}}});
    const hid_t gas = H5Gcreate2(handle, "PartType0", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put(gas, "Coordinates", {1, 2, 3, 4, 5, 6}, 2, 3);
    put(gas, "Velocities", {0, 0, 1, 3, 4, 0}, 2, 3);
    put(gas, "InternalEnergy", {10, 20}, 2, 1);
    put(gas, "Metallicity", {0.1, 0.2}, 2, 1);
    H5Gclose(gas);
    H5Fclose(handle);
    const Points points = read_points(dir / "s.hdf5");
    EXPECT_EQ(points.length_unit, "0.7142858 kpc") << "0.5 / 0.7";
    EXPECT_EQ(points.velocity_unit, "0.7071068 km/s") << "of sqrt(a)";
    EXPECT_EQ(point_value_unit(points, "InternalEnergy"), "km2/s2");
    EXPECT_EQ(point_value_unit(points, "Metallicity"), "");
    EXPECT_EQ(point_value_unit(points, "Masses"), "1.428995e+10 Msun");

    const Gaussians model =
        convert_points(points, {.value = "Masses", .radius = 1, .fields = {{"velocity"}}});
    EXPECT_EQ(model.fields.vector.at(0).unit, "0.7071068 km/s");
    for (const char* name : {"m.ply", "m.vogz"}) {
        write_model(dir / name, model);
        const Gaussians back = read_model(dir / name);
        EXPECT_EQ(back.content.units, model.content.units) << name;
        PictureRequest request;
        request.show = Show::column;
        const Scene scene = scene_of(back);
        EXPECT_NE(resolve(request, scene).unit.find("Msun/kpc2"), std::string::npos);
        request.unit = "g/cm2";
        const double length = kKpc * kScale / kHubble, mass = kMass / kHubble;
        constexpr double kDigits = 1e-5;  // seven in each text, of a length to the third power
        EXPECT_NEAR(resolve(request, scene).factor / (mass / (length * length)), 1, kDigits);
        request.unit = "K";
        EXPECT_THROW((void)resolve(request, scene), Error);
    }
}

TEST(points_hdf5, units_of_arrays_are_those_that_their_attributes_state) {
    using Numbers = std::map<std::string, double>;
    const auto unit = [](const char* array, const Numbers& own, const Numbers& common) {
        const auto reader = [](const Numbers& from) {
            return [&from](const char* name) {
                const auto at = from.find(name);
                return at == from.end() ? std::nullopt : std::optional(at->second);
            };
        };
        return point_files::snapshot_unit(array, reader(own), reader(common));
    };
    const Numbers swift{{"Unit length in cgs (U_L)", 3.08567758e24},
                        {"Unit mass in cgs (U_M)", 1.98841e43},
                        {"Unit time in cgs (U_t)", 3.08567758e19},
                        {"Redshift", 1}};
    EXPECT_EQ(unit("Coordinates", {}, swift), "0.5 Mpc");
    const char* const physical =
        "Conversion factor to physical CGS (including cosmological corrections)";
    EXPECT_EQ(unit("Pressures",
                   {{"U_L exponent", -1},
                    {"U_M exponent", 1},
                    {"U_t exponent", -2},
                    {physical, 1.98841e43 / (3.08567758e24 * 3.08567758e19 * 3.08567758e19)}},
                   swift),
              "1e+10 Msun km2/s2/Mpc3");
    const Numbers arepo{
        {"UnitLength_in_cm", 3.08567758e21}, {"UnitMass_in_g", 1.98841e43}, {"HubbleParam", 0.5}};
    EXPECT_EQ(unit("StarFormationRate", {{"mass_scaling", 1}, {"length_scaling", 0}}, arepo),
              "1e+10 Msun");
    EXPECT_EQ(unit("Coordinates", {{"CGSConversionFactor", 3.08567758e24}}, arepo), "2000 kpc");
    EXPECT_EQ(unit("Velocities", {}, arepo), "") << "no unit of velocity";
    const Numbers eagle{{"CGSConversionFactor", 1.98841e43}, {"h-scale-exponent", -1}};
    EXPECT_EQ(unit("Mass", eagle, arepo), "2e+10 Msun");
    EXPECT_EQ(unit("Velocity", {{"CGSConversionFactor", 1e5}, {"aexp-scale-exponent", 0.5}}, {}),
              "km/s");
    const Numbers gizmo{{"UnitLength_In_CGS", 3.08567758e21},
                        {"UnitMass_In_CGS", 1.98841e43},
                        {"UnitVelocity_In_CGS", 1e5}};
    EXPECT_EQ(unit("Coordinates", {}, gizmo), "kpc");
    EXPECT_EQ(unit("Masses", {}, gizmo), "1e+10 Msun");
    EXPECT_EQ(unit("Velocities", {}, gizmo), "km/s");
    EXPECT_EQ(unit("Abundance", {}, arepo), "");
}

namespace {

/// A snapshot of one type with Coordinates, and an array that `add` writes into its group.
template <class Add>
void write_one_type(const std::filesystem::path& file, const char* type, const Add& add) {
    const hid_t handle = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t group = H5Gcreate2(handle, type, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put(group, "Coordinates", {1, 2, 3, 4, 5, 6}, 2, 3);
    add(handle, group);
    H5Gclose(group);
    H5Fclose(handle);
}

void put_virtual(hid_t group, const char* name, std::initializer_list<const char*> files,
                 const char* array, hsize_t components) {
    const hsize_t all[2] = {2 * files.size(), components}, some[2] = {2, components};
    const int rank = components > 1 ? 2 : 1;
    const hid_t space = H5Screate_simple(rank, all, nullptr),
                part = H5Screate_simple(rank, some, nullptr);
    const hid_t layout = H5Pcreate(H5P_DATASET_CREATE);
    hsize_t start[2] = {0, 0};
    for (const char* file : files) {
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, nullptr, some, nullptr);
        H5Pset_virtual(layout, space, file, array, part);
        start[0] += 2;
    }
    H5Sselect_all(space);
    H5Dclose(H5Dcreate2(group, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, layout, H5P_DEFAULT));
    H5Pclose(layout), H5Sclose(part), H5Sclose(space);
}

}  // namespace

TEST(points_hdf5, types_without_particles_are_no_choice) {
    const TempDir dir;
    write_one_type(dir / "s.hdf5", "PartType1", [](hid_t file, hid_t) {
        H5Gclose(H5Gcreate2(file, "PartType0", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
        const hid_t none = H5Gcreate2(file, "PartType4", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        put(none, "Coordinates", {}, 0, 3);
        H5Gclose(none);
    });
    EXPECT_EQ(point_types(dir / "s.hdf5"), std::vector<std::string>{"PartType1"});
    EXPECT_EQ(read_points(dir / "s.hdf5").size(), 2u);
    for (const auto& [type, reason] : {std::pair{"PartType0", "PartType0 has no particles"},
                                       {"PartType4", "PartType4 has no particles"},
                                       {"PartType5", "no particles 'PartType5'"}}) {
        const std::string message = refusal([&] { read_points(dir / "s.hdf5", {.grid = type}); });
        EXPECT_NE(message.find(reason + std::string("; choose one with --grid (it has: "
                                                    "PartType1)")),
                  std::string::npos)
            << message;
    }
}

TEST(points_hdf5, gas_whose_positions_cannot_be_read_is_not_replaced_by_another_type) {
    const TempDir dir;
    write_one_type(dir / "s.hdf5", "PartType1", [](hid_t file, hid_t) {
        const hid_t gas = H5Gcreate2(file, "PartType0", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        put(gas, "Coordinates", {1, 2, 3, 4, 5, 6}, 3, 2);
        H5Gclose(gas);
    });
    EXPECT_NE(refusal([&] { read_points(dir / "s.hdf5"); })
                  .find("PartType0 has arrays, but no Coordinates of 3 numbers each; expected "
                        "them, or another type by --grid (it has: PartType1)"),
              std::string::npos);
    EXPECT_EQ(read_points(dir / "s.hdf5", {.grid = "PartType1"}).size(), 2u);
}

TEST(points_hdf5, parts_of_a_snapshot_may_lack_the_type) {
    const TempDir dir;
    write_snapshot(dir / "s.0.hdf5", true);  // PartType0 and PartType1
    write_one_type(dir / "s.1.hdf5", "PartType0", [](hid_t, hid_t group) {
        put(group, "Velocities", {0, 0, 1, 3, 4, 0}, 2, 3);
        put(group, "Density", {10, 20}, 2, 1);
        put(group, "MagneticField", {3, 4, 0, 0, 0, 2}, 2, 3);
        put(group, "Masses", {1, 2}, 2, 1);
    });
    const std::vector<std::filesystem::path> parts{dir / "s.0.hdf5", dir / "s.1.hdf5"};
    std::vector<std::string> notes;
    EXPECT_EQ(read_points(parts, {.grid = "PartType1"}, &notes).size(), 1u);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("s.1.hdf5: no particles of PartType1"), std::string::npos) << notes[0];
    EXPECT_EQ(read_points(parts, {.grid = "PartType0"}, nullptr).size(), 4u);
    EXPECT_EQ(read_points(parts, {}, nullptr).size(), 4u) << "gas";
    const std::string message =
        refusal([&] { read_points(parts, {.grid = "PartType7"}, nullptr); });
    EXPECT_NE(message.find("the files have: PartType0, PartType1"), std::string::npos) << message;
}

/// EAGLE's names are singular.
TEST(points_hdf5, mass_and_velocity_are_those_of_the_file) {
    const TempDir dir;
    write_one_type(dir / "s.hdf5", "PartType0", [](hid_t file, hid_t group) {
        put_head(file, {{"MassTable", {7, 0, 0, 0, 0, 0}}});
        put(group, "Mass", {1, 2}, 2, 1);
        put(group, "Velocity", {0, 0, 1, 3, 4, 0}, 2, 3);
    });
    const Points points = read_points(dir / "s.hdf5");
    EXPECT_EQ(point_value_names(points), (std::vector<std::string>{"count", "speed", "Mass"}));
    EXPECT_EQ(points.velocity.at(1), (Vec3f{3, 4, 0}));
}

TEST(points_hdf5, parts_in_other_units_are_refused) {
    const TempDir dir;
    const auto write = [&](const char* name, double gram, double speed) {
        write_one_type(dir / name, "PartType0", [&](hid_t file, hid_t group) {
            put_head(file, {{"UnitLength_in_cm", {3.085678e21}},
                            {"UnitMass_in_g", {gram}},
                            {"UnitVelocity_in_cm_per_s", {speed}}});
            put(group, "Masses", {1, 2}, 2, 1);
            put(group, "Velocities", {0, 0, 1, 3, 4, 0}, 2, 3);
        });
        return dir / name;
    };
    const std::filesystem::path first = write("s.0.hdf5", 1.989e43, 1e5);
    for (const auto& [part, reason] :
         {std::pair{write("mass.hdf5", 1.989e33, 1e5),
                    "mass.hdf5: 'Masses' in '1.989e+33 g', expected '1.000297e+10 Msun' as in"},
          {write("none.hdf5", 0, 1e5), "none.hdf5: 'Masses' in no unit"},
          {write("speed.hdf5", 1.989e43, 1e2),
           "speed.hdf5: velocities in '0.001 km/s', expected"}}) {
        const std::vector<std::filesystem::path> parts{first, part};
        const std::string message = refusal([&] { read_points(parts, {}, nullptr); });
        EXPECT_NE(message.find(reason), std::string::npos) << message;
    }
}

TEST(points_hdf5, a_part_of_a_snapshot_is_noted_unless_all_are_read) {
    const TempDir dir;
    const auto write = [&](const char* name, const Head& head) {
        write_one_type(dir / name, "PartType1", [&](hid_t file, hid_t) { put_head(file, head); });
        return dir / name;
    };
    const Head head{{"NumFilesPerSnapshot", {2}},
                    {"NumPart_ThisFile", {0, 2, 0}},
                    {"NumPart_Total", {0, 4, 0}}};
    const std::vector<std::filesystem::path> parts{write("s.0.hdf5", head),
                                                   write("s.1.hdf5", head)};
    const auto notes_of = [](std::span<const std::filesystem::path> files) {
        std::vector<std::string> notes;
        read_points(files, {}, &notes);
        return notes;
    };
    EXPECT_TRUE(notes_of(parts).empty());
    const std::vector<std::string> one = notes_of(std::span(parts).first(1));
    ASSERT_EQ(one.size(), 1u);
    EXPECT_NE(
        one[0].find("s.0.hdf5: 1 of the 2 files of a snapshot, with 2 of 4 particles; name all"),
        std::string::npos)
        << one[0];
    // Files over all parts have all particles, beyond 32 bits too; a head without totals says less.
    const auto alone = [&](const Head& own) {
        const std::filesystem::path file = write("s.hdf5", own);
        return notes_of(std::span(&file, 1));
    };
    EXPECT_TRUE(alone({{"NumFilesPerSnapshot", {2}}, {"NumPart_Total", {0, 2, 0}}}).empty());
    EXPECT_TRUE(alone({{"NumFilesPerSnapshot", {1}}}).empty());
    EXPECT_NE(
        alone({{"NumFilesPerSnapshot", {8}}}).at(0).find("8 files of a snapshot, with 2 part"),
        std::string::npos);
    EXPECT_NE(alone({{"NumFilesPerSnapshot", {8}},
                     {"NumPart_Total", {0, 2, 0}},
                     {"NumPart_Total_HighWord", {0, 1, 0}}})
                  .at(0)
                  .find("2 of 4294967298 particles"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  alone({{"NumPart_ThisFile", {0, 3, 0}}});
              }).find("2 rows of PartType1/Coordinates, but Header/NumPart_ThisFile states 3"),
              std::string::npos);
}

TEST(points_hdf5, chunks_that_were_never_written_have_the_fill_value) {
    const TempDir dir;
    write_one_type(dir / "s.hdf5", "PartType0", [](hid_t, hid_t group) {
        const hsize_t size = 2, chunk = 1;
        const double fill = 2.5, first = 7;
        const hid_t space = H5Screate_simple(1, &size, nullptr),
                    layout = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(layout, 1, &chunk);
        H5Pset_fill_value(layout, H5T_NATIVE_DOUBLE, &fill);
        for (const char* name : {"Masses", "Density"}) {
            const hid_t set =
                H5Dcreate2(group, name, H5T_IEEE_F64LE, space, H5P_DEFAULT, layout, H5P_DEFAULT);
            if (std::string(name) == "Density") {
                H5Sselect_hyperslab(space, H5S_SELECT_SET, std::vector<hsize_t>{0}.data(), nullptr,
                                    &chunk, nullptr);
                const hid_t one = H5Screate_simple(1, &chunk, nullptr);
                H5Dwrite(set, H5T_NATIVE_DOUBLE, one, space, H5P_DEFAULT, &first);
                H5Sclose(one);
            }
            H5Dclose(set);
        }
        H5Pclose(layout), H5Sclose(space);
    });
    const Points points = read_points(dir / "s.hdf5");
    EXPECT_EQ(point_values(points, "Masses"), (BigVector<float>{2.5f, 2.5f}));
    EXPECT_EQ(point_values(points, "Density"), (BigVector<float>{7, 2.5f}));
}

/// SWIFT writes parts, and a file of virtual arrays over all of them.
TEST(points_hdf5, virtual_arrays_are_read_from_their_parts) {
    const TempDir dir;
    for (const char* name : {"s.0.hdf5", "s.1.hdf5"})
        write_one_type(dir / name, "PartType0", [&](hid_t, hid_t group) {
            put(group, "Masses", {1.0 * (name[2] - '0'), 5}, 2, 1);
        });
    const hid_t all = H5Fcreate((dir / "s.hdf5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    const hid_t group = H5Gcreate2(all, "PartType0", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    put_virtual(group, "Coordinates", {"s.0.hdf5", "s.1.hdf5"}, "PartType0/Coordinates", 3);
    put_virtual(group, "Masses", {"s.0.hdf5", "s.1.hdf5"}, "PartType0/Masses", 1);
    H5Gclose(group);
    H5Fclose(all);
    const Points points = read_points(dir / "s.hdf5");
    ASSERT_EQ(points.size(), 4u);
    EXPECT_EQ(points.position[3], (Vec3d{4, 5, 6}));
    EXPECT_EQ(point_values(points, "Masses"), (BigVector<float>{0, 5, 1, 5}));
    std::filesystem::remove(dir / "s.1.hdf5");
    EXPECT_NE(refusal([&] {
                  read_points(dir / "s.hdf5");
              }).find("'PartType0/Coordinates' lies in s.1.hdf5, which is not there"),
              std::string::npos);
}

TEST(points_hdf5, masses_beyond_floats_have_a_unit) {
    const TempDir dir;
    write_one_type(dir / "s.hdf5", "PartType0", [](hid_t, hid_t group) {
        put(group, "Masses", {2e43, 1e43}, 2, 1);
    });
    const Points points = read_points(dir / "s.hdf5");
    EXPECT_EQ(points.attributes.at(0).unit, 1e43);
    EXPECT_EQ(point_values(points, "Masses"), (BigVector<float>{2, 1}));
}

TEST(points_hdf5, files_in_the_table_of_reports) {
    const auto folder = source_dir() / ".." / "shared" / "reported";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is absent";
    EXPECT_EQ(read_points(folder / "emptygroup.hdf5").size(), 200u);
    EXPECT_EQ(point_values(read_points(folder / "fill.hdf5"), "Masses"), BigVector<float>(200, 2));
    EXPECT_EQ(read_points(folder / "f32big.hdf5").attributes.at(0).unit, 1e43);
    const std::vector<std::filesystem::path> parts{folder / "snap.0.hdf5", folder / "snap.1.hdf5"};
    for (const auto& [type, count] :
         {std::pair{"PartType0", 200u}, {"PartType1", 100u}, {"PartType5", 3u}})
        EXPECT_EQ(read_points(parts, {.grid = type}, nullptr).size(), count) << type;
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
