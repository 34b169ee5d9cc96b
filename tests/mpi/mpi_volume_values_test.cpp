// mpi_volume_values_test.cpp: vog-mpi render of volumes by value, and of their fields and maxima, gives the pictures of vog
// render: parts are runs of leaves, which lie before and behind each other on a ray.
#include <nlohmann/json.hpp>

#include "mpi_pictures.h"
#include "support/vdb_grids.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

/// Cube of voxels from index 0 on.
/// across    voxels along each edge
/// value_of  called with the index of each
template <class ValueOf>
Volume cube_of_values(const std::string& name, int across, const Affine& world_from_index,
                      const ValueOf& value_of) {
    Volume volume;
    volume.name = name;
    volume.world_from_index = world_from_index;
    for (int x = 0; x < across; x += kLeafEdge)
        for (int y = 0; y < across; y += kLeafEdge)
            for (int z = 0; z < across; z += kLeafEdge) {
                Leaf& leaf = volume.leaves.emplace_back();
                leaf.origin = {x, y, z};
                for (int n = 0; n < kLeafVoxels; ++n) {
                    const Vec3i index = leaf.origin + Vec3i{n >> 6, n >> 3 & 7, n & 7};
                    if (std::max({index.x, index.y, index.z}) < across)
                        leaf.set(n, value_of(index));
                }
            }
    return volume;
}

/// Lattice along the world's axes.
Affine lattice(double voxel, Vec3d origin) {
    Affine map;
    for (Vec3d& row : map.linear.row) row = voxel * row;
    map.translation = origin;
    return map;
}

}  // namespace

class mpi_volume_values : public MpiPictures {};

TEST_P(mpi_volume_values, emission_and_absorption_are_the_same) {
    must("sample explosion e.vdb --size 64");
    // From inside: pieces begin at the eye.
    EXPECT_LE(picture_difference(
                  "e.vdb --band 0.02,0.1,orange,0.2 --iso 0.4,white --light head --unit-distance "
                  "0.1 --eye 0.1,0.05,0.3 --look-at 0,0,0"),
              kSamePicture);
    EXPECT_LE(picture_difference("e.vdb --orthographic --view +x --tf viridis --samples 2 "
                                 "--clip -0.2,-0.4,-1,0.3,0.4,1 --clip 0,1,1,-0.2"),
              kSamePicture);
    EXPECT_LE(picture_difference("e.vdb --light 1,2,1 --unit-distance 0.02 --view -z"),
              kSamePicture);
    EXPECT_LE(picture_difference("e.vdb --light studio --tf viridis"), kSamePicture);
}

TEST_P(mpi_volume_values, layers_are_the_same) {
    must("sample explosion e.vdb --size 64");
    must("sample cloud c.vdb --size 64");
    must("export e.vdb --iso 0.4 -o e.stl");
    const std::string layers =
        "e.vdb --layer tf=hot,unit-distance=0.1 --layer c.vdb,tf=viridis,unit-distance=0.05 ";
    EXPECT_LE(picture_difference(layers + "--light head"), kSamePicture);
    EXPECT_LE(picture_difference(layers + "--light studio --samples 2 --clip 0,1,1,-0.2"),
              kSamePicture);
    EXPECT_LE(picture_difference(layers + "--layer e.stl,color=white,opacity=0.5"), kSamePicture);
    EXPECT_LE(picture_difference(layers + "--layer e.stl,color=white"), kSamePicture);
}

/// The leaf of a voxel and those of its neighbours may be of different ranks, of the field as of the density.
TEST_P(mpi_volume_values, gradients_reach_into_other_parts) {
    must("sample cloud c.vdb --size 64");
    must("sample explosion h.vdb --size 64");
    EXPECT_LE(picture_difference("c.vdb --field heat=h.vdb:density --light head --tf inferno"),
              kSamePicture);
}

TEST_P(mpi_volume_values, means_deviations_and_maxima_are_the_same) {
    must("sample cloud c.vdb --size 64");
    must("sample explosion h.vdb --size 64");
    const std::string heat = "c.vdb --field heat=h.vdb:density ";
    for (const std::string options :
         {"--show mean", "--show deviation --samples 2 --clip -0.2,-0.1,-1,0.3,0.2,1",
          // Larger voxels than pixels under parallel rays: added box by box.
          "--show mean --orthographic --view +y --width 0.3",
          "--show mean --interpolation linear --set step=0"}) {
        SCOPED_TRACE(options);
        EXPECT_LE(field_difference(heat + options).most(), kSamePicture);
    }
    EXPECT_LE(maximum_difference(heat + "--samples 2 --clip 1,0,0,0.1"), kSamePicture);
    EXPECT_LE(maximum_difference("c.vdb --eye 0.1,0.1,0.2 --look-at 0,0,0"), kSamePicture);
}

TEST_P(mpi_volume_values, slices_are_the_same) {
    must("sample cloud c.vdb --size 64");
    must("sample explosion h.vdb --size 64");
    must("sample amr a.vdb --size 64");
    const std::string heat = " --field heat=h.vdb:density", levels = "a.vdb --grid 'density_L*' ",
                      of_levels = " --field 'd=density_L*'";
    for (const std::string& options : std::vector<std::string>{
             "c.vdb --plane z", "c.vdb --plane z" + heat + " --samples 2",
             "c.vdb --plane 1,1,0,0 --thickness 0.1", "c.vdb --plane x --thickness 0.1" + heat,
             levels + "--plane y", levels + "--plane z --thickness 0.3",
             levels + "--plane x" + of_levels, levels + "--plane x --thickness 0.3" + of_levels}) {
        SCOPED_TRACE(options);
        EXPECT_LE(value_difference(options + " --show slice"), kSamePicture);
    }
}

TEST_P(mpi_volume_values, levels_that_hide_each_other_are_the_same) {
    must("sample amr a.vdb --size 64");
    const std::string levels = "a.vdb --grid 'density_L*' ";
    EXPECT_LE(picture_difference(levels + "--tf viridis"), kSamePicture);
    EXPECT_LE(picture_difference(levels + "--light head --iso 2,white --threshold 0.5"),
              kSamePicture);
    EXPECT_LE(field_difference(levels + "--show mean --field 'd=density_L*'").most(), kSamePicture);
    EXPECT_LE(maximum_difference(levels), kSamePicture);
    // Volumes that add up: where they overlap, so do their extinctions.
    EXPECT_LE(picture_difference(levels + "--combine sum --unit-distance 0.02"), kSamePicture);
    EXPECT_LE(maximum_difference(levels + "--combine sum"), kSamePicture);
}

/// Lattices that do not fit: voxels hidden in part.
TEST_P(mpi_volume_values, levels_that_cut_voxels_are_the_same) {
    const auto value = [](Vec3i index) {
        return 0.2f + 0.1f * static_cast<float>((3 * index.x + index.y + 2 * index.z) % 7);
    };
    const std::vector<Volume> levels{
        cube_of_values("density_L0", 20, {}, value),
        cube_of_values("density_L1", 17, lattice(0.5, {4.9, 4.0, 5.8}), value)};
    write_vdb(dir_ / "cut.vdb", levels);
    const std::string mesh = "cut.vdb --grid 'density_L*' --combine mesh ";
    EXPECT_LE(picture_difference(mesh + "--light head --unit-distance 2"), kSamePicture);
    EXPECT_LE(maximum_difference(mesh), kSamePicture);
    EXPECT_LE(field_difference(mesh + "--show mean --field 'd=density_L*'").most(), kSamePicture);
}

/// Rays within the faces between leaves of different ranks, on a lattice that floats do not have: each is in one voxel.
TEST_P(mpi_volume_values, rays_in_faces_between_parts_are_in_one_of_them) {
    write_vdb(dir_ / "faces.vdb",
              cube_of_values("density", 40, lattice(0.1, {0.1, -0.7, 12.3}), [](Vec3i index) {
                  return 1 + static_cast<float>(index.x / 8 % 2 + index.y / 8 % 3 + index.z / 8);
              }));
    for (const std::string view : {"+x", "+y", "-z"}) {
        SCOPED_TRACE(view);
        // Pixels of 8/5 voxels: of those about the middle of 40 voxels, every fifth is in a face between leaves.
        const std::string faces = "faces.vdb --orthographic --width 24 --view " + view;
        EXPECT_LE(picture_difference(faces + " --unit-distance 1"), kSamePicture);
        EXPECT_LE(maximum_difference(faces), kSamePicture);
    }
}

/// Hounsfield units, vectors.
TEST_P(mpi_volume_values, signed_values_and_vectors_are_the_same) {
    const auto units = make_grid("hu", openvdb::GRID_UNKNOWN);
    const auto density = make_grid("density");
    const auto wind = make_grid<openvdb::Vec3SGrid>("wind", openvdb::GRID_UNKNOWN);
    for (int x = 0; x < 24; ++x)
        for (int y = 0; y < 20; ++y)
            for (int z = 0; z < 16; ++z) {
                const auto wave = float(std::sin(0.4 * x) + std::cos(0.3 * y) * std::sin(0.5 * z));
                set_voxel(*units, {x, y, z}, 1000 * wave);
                set_voxel(*density, {x, y, z}, 2 + wave);
                set_voxel(*wind, {x, y, z}, openvdb::Vec3s{wave, float(x) - 9, -wave * wave});
            }
    write_grids(dir_ / "ct.vdb", {units});
    write_grids(dir_ / "wind.vdb", {density, wind});
    EXPECT_LE(picture_difference("ct.vdb --window 200,900 --light head --unit-distance 2"),
              kSamePicture);
    EXPECT_LE(maximum_difference("ct.vdb"), kSamePicture);
    EXPECT_LE(field_difference("wind.vdb --grid density --show mean --field wind").most(),
              kSamePicture);
    EXPECT_LE(
        field_difference("wind.vdb --grid density --show deviation --field wind.magnitude").most(),
        kSamePicture);
    EXPECT_LE(picture_difference("wind.vdb --grid density --field wind.y --tf coolwarm"),
              kSamePicture);
}

INSTANTIATE_TEST_SUITE_P(ranks, mpi_volume_values, testing::ValuesIn(rank_counts()),
                         testing::PrintToStringParamName());

class mpi_volume_inputs : public Mpi {};

/// One leaf: the other ranks have no voxel, and take part in choosing the unit distance.
TEST_F(mpi_volume_inputs, ranks_without_a_voxel_draw_and_report_the_same) {
    Volume volume;
    volume.name = "density";
    volume.leaves.resize(1);
    for (int n = 0; n < kLeafVoxels; ++n) volume.leaves[0].set(n, 1.0f + static_cast<float>(n % 7));
    write_vdb(dir_ / "leaf.vdb", volume);
    for (const std::string show : {"volume --light head", "maximum", "mean --field density"}) {
        const std::string render = "render leaf.vdb --size 70 --json -o same.png --show " + show;
        auto one = nlohmann::json::parse(must(render).out);
        const std::string picture = read_text(dir_ / "same.png");
        auto many = nlohmann::json::parse(must_mpi(4, render).out);
        EXPECT_EQ(read_text(dir_ / "same.png"), picture) << show;
        for (nlohmann::json* report : {&one, &many})
            for (const char* rounded :
                 {"ms", "render_ms", "peak_memory", "threads", "mean_opacity", "mean_t"})
                report->erase(rounded);
        EXPECT_EQ(one.dump(1), many.dump(1)) << show;
    }
}

/// With four or more files per rank, files go to ranks whole.
TEST_F(mpi_volume_inputs, many_files_are_divided_by_files) {
    std::string files;
    for (int n = 0; n < 8; ++n) {
        must(fmt::format("sample cloud v{}.vdb --size 64 --set seed={}", n, n + 1));
        files += fmt::format(" v{}.vdb", n);
    }
    const std::string render =
        "render" + files + " --combine sum --size 40 --background transparent ";
    for (const std::string show : {"volume --light head", "mean --field density"}) {
        must(render + "-o one.png --show " + show);
        must_mpi(2, render + "-o many.png --show " + show);
        const Image one = read_image(dir_ / "one.png"), many = read_image(dir_ / "many.png");
        for (std::size_t n = 0; n < one.pixel.size(); ++n)
            ASSERT_NEAR(one.pixel[n].g, many.pixel[n].g, 1.01 / 255) << show << " " << n;
    }
}

TEST_F(mpi_volume_inputs, what_parts_cannot_show_is_refused) {
    must("sample cloud c.vdb --size 64");
    must("sample amr a.vdb --size 64");
    const auto refuse = [&](int code, const std::string& arguments, const std::string& text) {
        must_fail_mpi(code, "-n 3 COMMAND render " + arguments + " -o c.png", text);
    };
    refuse(2, "c.vdb --show volume --interpolation linear",
           "--show volume with --interpolation linear: samples begin where a ray enters");
    refuse(2, "c.vdb --show mean --field density --interpolation linear", "use --set step=0");
    refuse(2,
           "a.vdb --grid 'density_L*' --show mean --field 'd=density_L*' --interpolation linear "
           "--set step=0",
           "levels of a mesh need values that other ranks hold");
    refuse(1, "c.vdb --show volume --field heat", "heat");
    refuse(1, "c.vdb --show volume --tf missing.json", "missing.json");
    refuse(1, "c.vdb --show volume --band 5000,6000,red,1", "outside the data's values");
    refuse(1, "c.vdb --show maximum --field c.vdb:none", "none");
    refuse(1, "nowhere.vdb --show volume", "nowhere.vdb");
    // One rank alone meets the bad value.
    const auto grid = make_grid("density");
    for (int n = 0; n < 64; ++n) set_voxel(*grid, {n, n % 9, 0}, n == 60 ? NAN : 1.0f);
    write_grids(dir_ / "nan.vdb", {grid});
    refuse(1, "nan.vdb --show volume", "nan");
    const auto low = make_grid("density");
    for (int n = 0; n < 64; ++n) set_voxel(*low, {n, n % 9, 0}, n == 60 ? -1.0f : 1.0f);
    write_grids(dir_ / "low.vdb", {low});
    refuse(1, "low.vdb --show mean --field density", "clip-negative");
}

}  // namespace vog::test
