// vdb_points_test.cpp: writing and reading of PointDataGrids, compared with OpenVDB's own.
#include <gtest/gtest.h>
#include <openvdb/points/PointAttribute.h>
#include <openvdb/points/PointConversion.h>

#include <map>
#include <random>
#include <tuple>

#include "support/refused_files.h"
#include "support/vdb_grids.h"
#include "vog/convert_points.h"
#include "vog/points.h"

namespace vog::test {

namespace {

namespace vp = openvdb::points;

Points some_points(std::size_t count) {
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    Points points;
    points.attributes = {{"mass", {}}};
    for (std::size_t n = 0; n < count; ++n) {
        points.position.push_back(
            {5e4 + normal(random), normal(random), n % 5 ? 3 * normal(random) : 0.25});
        points.velocity.push_back({float(normal(random)), 2, float(n)});
        points.attributes[0].value.push_back(float(n) + 0.5f);
    }
    return points;
}

/// Positions of the particles, ordered by their attribute mass, which numbers them.
std::map<float, Vec3d> by_mass(const Points& points) {
    std::map<float, Vec3d> places;
    for (std::size_t n = 0; n < points.size(); ++n)
        places[points.attributes[0].value[n]] = points.position[n];
    return places;
}

/// Points at the corners of a lattice, as OpenVDB stores them.
vp::PointDataGrid::Ptr openvdb_points(int edge) {
    openvdb::initialize();
    std::vector<openvdb::Vec3s> positions;
    for (int n = 0; n < edge * edge * edge; ++n)
        positions.emplace_back(float(n % edge), float(n / edge % edge),
                               float(n / edge / edge) + 0.01f * float(n % 7));
    const auto transform = openvdb::math::Transform::createLinearTransform(0.5);
    const auto grid =
        vp::createPointDataGrid<vp::NullCodec, vp::PointDataGrid>(positions, *transform);
    grid->setName("particles");
    return grid;
}

template <class Value>
void set_values(vp::PointDataGrid& grid, const std::string& name, int modulus) {
    for (auto leaf = grid.tree().beginLeaf(); leaf; ++leaf) {
        vp::AttributeWriteHandle<Value> handle(leaf->attributeArray(name));
        for (openvdb::Index n = 0; n < handle.size(); ++n)
            handle.set(n, Value(static_cast<Value>(static_cast<int>(n) % modulus)));
    }
}

}  // namespace

TEST(vdb_points, what_is_written_reads_back_in_the_order_of_leaves) {
    const TempDir dir;
    const Points points = some_points(20000);
    write_points(dir / "p.vdb", points);
    EXPECT_TRUE(vdb_holds_points(dir / "p.vdb"));
    const Points back = read_points(dir / "p.vdb");
    ASSERT_EQ(back.size(), points.size());
    ASSERT_EQ(back.attributes.size(), 1u);
    EXPECT_EQ(back.attributes[0].name, "mass");
    const auto places = by_mass(back);
    const double voxel = point_voxel_size(points);
    for (std::size_t n = 0; n < points.size(); ++n) {
        const Vec3d place = places.at(points.attributes[0].value[n]);
        EXPECT_LT(length(place - points.position[n]), 1e-7 * voxel + 1e-11);
    }
    for (std::size_t n = 0; n < back.size(); ++n)
        EXPECT_EQ(back.velocity[n].z, back.attributes[0].value[n] - 0.5f);
    // The paper's conversion keeps this order.
    const Gaussians model = convert_points_paper(points, "mass");
    EXPECT_EQ(model.density, back.attributes[0].value);
    // The same particles give the same file.
    write_points(dir / "q.vdb", points);
    std::ifstream p(dir / "p.vdb", std::ios::binary), q(dir / "q.vdb", std::ios::binary);
    EXPECT_TRUE(
        std::equal(std::istreambuf_iterator<char>(p), {}, std::istreambuf_iterator<char>(q)));
}

/// Columns that become fields of a model.
TEST(vdb_points, velocity_and_named_attributes_go_from_text_to_vdb_and_back) {
    const TempDir dir;
    write_bytes(dir / "a.csv",
                "x,y,z,velocity_x,velocity_y,velocity_z,temperature,mass\n"
                "1,2,3,-4,5,-6,300,7\n1.5,2,3,4,-5,6,-20.5,8\n");
    for (const char* between : {"b.vdb", "b.tsv", "b.xyz"}) {
        write_points(dir / between, read_points(dir / "a.csv"));
        const Points points = read_points(dir / between);
        ASSERT_EQ(points.size(), 2u);
        ASSERT_EQ(points.attributes.size(), 2u);
        EXPECT_EQ(points.attributes[0].name, "temperature");
        EXPECT_EQ(points.attributes[1].name, "mass");
        const std::size_t cold = points.attributes[0].value[0] < 0 ? 0 : 1;
        EXPECT_EQ(points.attributes[0].value[cold], -20.5f);
        EXPECT_EQ(points.attributes[1].value[cold], 8);
        EXPECT_EQ(points.velocity[cold], (Vec3f{4, -5, 6}));
        EXPECT_EQ(points.velocity[1 - cold], (Vec3f{-4, 5, -6}));
    }
}

/// OpenVDB fills small pages up to 128 bytes before it compresses them.
TEST(vdb_points, a_few_equal_points_are_read) {
    const TempDir folder;
    for (const std::size_t count : {1u, 2u, 9u, 10u, 11u, 40u}) {
        Points points;
        points.position.assign(count, {1, 2, 3});
        points.attributes = {{"mass", BigVector<float>(count, 2.0f)}};
        write_points(folder / "points.vdb", points);
        const Points again = read_points(folder / "points.vdb");
        ASSERT_EQ(again.size(), count);
        EXPECT_EQ(again.position, points.position);
        EXPECT_EQ(again.attributes[0].value, points.attributes[0].value);
    }
}

TEST(vdb_points, openvdb_reads_what_is_written) {
    const TempDir dir;
    const Points points = some_points(3000);
    write_points(dir / "p.vdb", points);
    openvdb::io::File file((dir / "p.vdb").string());
    file.open();
    const auto grid = openvdb::gridPtrCast<vp::PointDataGrid>(file.readGrid("points"));
    EXPECT_EQ(vp::pointCount(grid->tree()), points.size());
    std::size_t voxels = 0;
    std::map<float, Vec3d> places;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
        leaf->validateOffsets();
        voxels += leaf->onVoxelCount();
        vp::AttributeHandle<openvdb::Vec3f> p(leaf->constAttributeArray("P"));
        vp::AttributeHandle<openvdb::Vec3f> velocity(leaf->constAttributeArray("velocity"));
        vp::AttributeHandle<float> mass(leaf->constAttributeArray("mass"));
        for (auto index = leaf->beginIndexOn(); index; ++index) {
            const openvdb::Vec3d at =
                grid->transform().indexToWorld(p.get(*index) + index.getCoord().asVec3d());
            places[mass.get(*index)] = {at.x(), at.y(), at.z()};
            EXPECT_EQ(velocity.get(*index).z(), mass.get(*index) - 0.5f);
        }
    }
    for (std::size_t n = 0; n < points.size(); ++n)
        EXPECT_LT(length(places.at(points.attributes[0].value[n]) - points.position[n]), 1e-7);
    // About one per voxel: a uniform scatter has 1.1 to 2.3 per occupied voxel.
    EXPECT_GT(double(points.size()) / double(voxels), 1.1);
    EXPECT_LT(double(points.size()) / double(voxels), 2.3);
}

TEST(vdb_points, every_codec_is_read) {
    const auto grid = openvdb_points(12);
    const std::vector<std::tuple<std::string, std::string, int>> scalars = {
        {"float", "null", 300},  {"float", "trnc", 300},  {"float", "ufxpt8", 2},
        {"float", "ufxpt16", 2}, {"double", "null", 300}, {"int16", "null", 300},
        {"int32", "null", 300},  {"int64", "null", 300},  {"int8", "null", 100},
        {"bool", "null", 2}};
    for (const auto& [type, codec, modulus] : scalars) {
        const std::string name = type + "_" + codec;
        vp::appendAttribute(grid->tree(), name, openvdb::NamePair(type, codec));
        if (type == "float") set_values<float>(*grid, name, modulus);
        if (type == "double") set_values<double>(*grid, name, modulus);
        if (type == "int8") set_values<int8_t>(*grid, name, modulus);
        if (type == "int16") set_values<int16_t>(*grid, name, modulus);
        if (type == "int32") set_values<int32_t>(*grid, name, modulus);
        if (type == "int64") set_values<int64_t>(*grid, name, modulus);
        if (type == "bool") set_values<bool>(*grid, name, modulus);
    }
    const std::vector<std::pair<std::string, double>> vectors = {
        {"null", 0}, {"trnc", 1e-3}, {"fxpt8", 3e-3}, {"fxpt16", 1e-5}, {"uvec", 2e-2}};
    const openvdb::Vec3f unit(0.36f, 0.48f, -0.8f);
    for (const auto& [codec, tolerance] : vectors) {
        const std::string name = "vec3s_" + codec;
        vp::appendAttribute(grid->tree(), name, openvdb::NamePair("vec3s", codec));
        const float scale = codec.starts_with("fxpt") ? 0.5f : 1;  // which end at 1/2
        for (auto leaf = grid->tree().beginLeaf(); leaf; ++leaf) {
            vp::AttributeWriteHandle<openvdb::Vec3f> handle(leaf->attributeArray(name));
            for (openvdb::Index n = 0; n < handle.size(); ++n) handle.set(n, scale * unit);
        }
    }
    vp::appendAttribute<openvdb::Vec3f>(grid->tree(), "velocity", unit);  // uniform
    vp::appendAttribute<openvdb::Name>(grid->tree(), "label");

    for (const std::uint32_t compression : {kDefaultCompression, std::uint32_t{0}}) {
        const TempDir dir;
        write_grids(dir / "p.vdb", {grid}, compression);
        const Points points = read_points(dir / "p.vdb");
        ASSERT_EQ(points.size(), 1728u);
        Box box;
        for (const Vec3d& p : points.position) box.include(p);
        EXPECT_NEAR(box.upper.x, 11, 1e-6);
        EXPECT_NEAR(box.upper.z, 11.06, 1e-5);
        EXPECT_NEAR(points.velocity[77].z, -0.8, 1e-6);
        ASSERT_EQ(points.attributes.size(), scalars.size() + vectors.size());
        for (std::size_t n = 0; n < scalars.size(); ++n) {
            const auto& [type, codec, modulus] = scalars[n];
            const PointAttribute& found = points.attributes[n];
            EXPECT_EQ(found.name, type + "_" + codec);
            EXPECT_EQ(found.value[5], float(5 % modulus)) << found.name;
            EXPECT_EQ(found.value[0], 0) << found.name;
        }
        for (std::size_t n = 0; n < vectors.size(); ++n)
            EXPECT_NEAR(points.attributes[scalars.size() + n].value[9],
                        vectors[n].first.starts_with("fxpt") ? 0.5 : 1, vectors[n].second)
                << vectors[n].first;
    }
}

TEST(vdb_points, positions_of_every_codec_are_where_openvdb_has_them) {
    openvdb::initialize();
    const std::vector<openvdb::Vec3s> positions{
        {1.3f, -2.2f, 9}, {1.31f, -2.2f, 9}, {-40, 0, 0.1f}};
    const auto transform = openvdb::math::Transform::createLinearTransform(0.7);
    transform->postRotate(0.3, openvdb::math::Z_AXIS);
    transform->postTranslate({1, 2, 3});
    const auto check = [&](const openvdb::GridBase::Ptr& grid, double tolerance) {
        grid->setName("p");
        const TempDir dir;
        write_grids(dir / "p.vdb", {grid});
        Points points = read_points(dir / "p.vdb");
        ASSERT_EQ(points.size(), 3u);
        for (const openvdb::Vec3s& p : positions) {
            double nearest = 1;
            for (const Vec3d& q : points.position)
                nearest = std::min(nearest, length(q - Vec3d{p.x(), p.y(), p.z()}));
            EXPECT_LT(nearest, tolerance);
        }
    };
    check(vp::createPointDataGrid<vp::NullCodec, vp::PointDataGrid>(positions, *transform), 1e-5);
    check(vp::createPointDataGrid<vp::FixedPointCodec<false>, vp::PointDataGrid>(positions,
                                                                                 *transform),
          1e-4);
    check(vp::createPointDataGrid<vp::FixedPointCodec<true>, vp::PointDataGrid>(positions,
                                                                                *transform),
          1e-2);
}

TEST(vdb_points, files_without_points_are_refused) {
    const TempDir dir;
    const auto volume = make_grid("density");
    set_voxel(*volume, {1, 2, 3}, 1);
    write_grids(dir / "v.vdb", {volume});
    EXPECT_FALSE(vdb_holds_points(dir / "v.vdb"));
    EXPECT_NE(error_of([&] { read_points(dir / "v.vdb"); }).find("no grids of points"),
              std::string::npos);
    const auto points = openvdb_points(3);
    write_grids(dir / "both.vdb", {volume, points});
    EXPECT_FALSE(vdb_holds_points(dir / "both.vdb"));
    EXPECT_TRUE(vdb_holds_points(dir / "both.vdb", "particles"));
    EXPECT_EQ(read_points(dir / "both.vdb").size(), 27u);
    EXPECT_NE(error_of([&] {
                  read_points(dir / "both.vdb", {{}, "density"});
              }).find("no grids of points named 'density'"),
              std::string::npos);
    const auto empty = make_grid<vp::PointDataGrid>("none", openvdb::GRID_UNKNOWN);
    write_grids(dir / "empty.vdb", {empty});
    const std::string message = error_of([&] { read_points(dir / "empty.vdb"); });
    EXPECT_NE(message.find("no particles"), std::string::npos) << message;
}

TEST(vdb_points, cut_and_changed_files_end_in_one_line) {
    const TempDir dir;
    const auto grid = openvdb_points(3);
    vp::appendAttribute<openvdb::Vec3f>(grid->tree(), "velocity", openvdb::Vec3f(1, 2, 3));
    write_grids(dir / "p.vdb", {grid});
    std::ifstream in(dir / "p.vdb", std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    ASSERT_GT(bytes.size(), 500u);
    // vdb_corrupt_test covers the topology; the last 1,500 bytes follow it.
    const std::size_t densely_from = bytes.size() > 1500 ? bytes.size() - 1500 : 0;
    const auto step = [&](std::size_t at) -> std::size_t { return at < densely_from ? 97 : 1; };
    testing::internal::CaptureStderr();
    for (std::size_t size = 0; size < bytes.size(); size += step(size)) {
        write_bytes(dir / "cut.vdb", bytes.substr(0, size));
        EXPECT_THROW((void)read_points(dir / "cut.vdb"), Error) << size << " of " << bytes.size();
    }
    for (std::size_t at = 0; at < bytes.size(); at += step(at))
        for (const int change : {0x01, 0x80, 0xff}) {
            std::string changed = bytes;
            changed[at] = static_cast<char>(changed[at] ^ change);
            write_bytes(dir / "changed.vdb", changed);
            try {
                (void)read_points(dir / "changed.vdb");
            } catch (const Error&) {
            }
        }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace vog::test
