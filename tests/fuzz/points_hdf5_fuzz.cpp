// points_hdf5_fuzz.cpp: Reader of snapshots in HDF5: files that the library writes, of any groups, shapes and types, whole or
// cut; what is read is written as text and read again.
#include <algorithm>
#include <span>

#include "fuzz_target.h"
#include "same_points.h"

#ifdef VOG_HDF5
#include <hdf5.h>
#endif

namespace vog::fuzz {

// Deflate packs a thousand bytes into one; numbers become doubles.
const Limits kLimits{.memory_ratio = 16384};

#ifdef VOG_HDF5

namespace {

template <std::size_t N>
hid_t one_of(Numbers& numbers, const hid_t (&all)[N]) {
    return all[static_cast<std::size_t>(numbers.below(N))];
}

/// Array of up to three dimensions, in one piece or in packed chunks, with values or without.
void draw_array(Numbers& numbers, hid_t group, const std::string& name) {
    const bool usual = numbers.byte() < 200;
    const int rank = usual ? 2 : numbers.below(4);
    hsize_t size[3];
    for (hsize_t& edge : size) edge = static_cast<hsize_t>(numbers.below(6));
    if (usual) size[0] = 2, size[1] = name == "Coordinates" || name == "Velocities" ? 3 : 1;
    const hid_t types[] = {H5T_IEEE_F64LE, H5T_IEEE_F32BE, H5T_STD_I32LE,
                           H5T_STD_U64BE,  H5T_C_S1,       H5T_STD_I8LE};
    const hid_t type = usual ? one_of(numbers, {H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_I64LE})
                             : one_of(numbers, types);
    const hid_t space = rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(rank, size, nullptr);
    const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
    if (rank > 0 && numbers.byte() % 4 == 0) {
        for (hsize_t& edge : size) edge = std::max<hsize_t>(edge, 1);
        H5Pset_chunk(how, rank, size);
        H5Pset_shuffle(how);
        H5Pset_deflate(how, 4);
    }
    const hid_t set = H5Dcreate2(group, name.c_str(), type, space, H5P_DEFAULT, how, H5P_DEFAULT);
    double values[6 * 6 * 6];
    for (double& value : values) value = double{numbers.number()};
    if (set >= 0 && numbers.byte() < 240 && type != H5T_C_S1)
        H5Dwrite(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
    if (set >= 0) H5Dclose(set);
    H5Pclose(how);
    H5Sclose(space);
}

/// Numbers of the head: masses, particles here and in all files, the number of files.
void draw_header(Numbers& numbers, hid_t file) {
    const hid_t header = H5Gcreate2(file, "Header", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    for (const char* name :
         {"MassTable", "NumPart_ThisFile", "NumPart_Total", "NumFilesPerSnapshot"}) {
        const auto count = static_cast<hsize_t>(numbers.below(12));
        const hid_t space = numbers.flag() ? H5Screate_simple(1, &count, nullptr)
                                           : H5Screate(numbers.flag() ? H5S_SCALAR : H5S_NULL);
        const hid_t type = one_of(numbers, {H5T_IEEE_F64LE, H5T_STD_I16BE, H5T_C_S1});
        const hid_t table = H5Acreate2(header, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
        double drawn[12];
        for (double& number : drawn) number = double{numbers.number()};
        if (numbers.byte() < 128) std::ranges::fill(drawn, 2.0);  // rows of a usual array
        if (table >= 0 && type != H5T_C_S1) H5Awrite(table, H5T_NATIVE_DOUBLE, drawn);
        if (table >= 0) H5Aclose(table);
        H5Sclose(space);
    }
    H5Gclose(header);
}

void draw_file(Numbers& numbers, const std::filesystem::path& path) {
    const hid_t file = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (numbers.flag()) draw_header(numbers, file);
    const int types = numbers.byte() < 200 ? 1 : numbers.below(4);
    for (int type = 0; type < types; ++type) {
        const std::string name = "PartType" + std::to_string(type * numbers.below(5));
        const hid_t group = H5Gcreate2(file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
        if (group < 0) continue;
        if (numbers.byte() < 240) draw_array(numbers, group, "Coordinates");
        const int arrays = numbers.below(4);
        for (int n = 0; n < arrays; ++n) {
            constexpr const char* kNames[] = {"Velocities", "Masses", "ParticleIDs", "Density"};
            std::string array = numbers.flag() ? kNames[numbers.below(4)] : numbers.text(8);
            if (array.find('/') == std::string::npos) draw_array(numbers, group, array);
        }
        H5Gclose(group);
    }
    H5Fclose(file);
}

}  // namespace

void run(Bytes input) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // names and shapes that the library refuses
    Numbers numbers(input);
    const std::filesystem::path file = scratch_file("input.hdf5");
    const bool cut = numbers.byte() % 8 == 0;
    const double share = numbers.share();
    draw_file(numbers, file);
    const auto size = static_cast<double>(std::filesystem::file_size(file));
    if (cut) std::filesystem::resize_file(file, static_cast<std::uintmax_t>(share * size));
    for (const char* group : {"", "PartType1"})
        for (const bool lenient : {false, true}) {
            Points points;
            std::vector<std::string> notes;
            const PointReadOptions options{.grid = group, .values = {lenient, false}};
            if (!accepted([&] { points = read_points(std::span(&file, 1), options, &notes); }))
                continue;
            expect(accepted([&] { validate(points); }), "particles that are read are valid");
            expect_round_trip(points, ".csv");
        }
}

#else

void run(Bytes) {}

#endif

}  // namespace vog::fuzz
