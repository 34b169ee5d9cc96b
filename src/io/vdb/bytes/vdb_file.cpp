// vdb_file.cpp: header, grid descriptors and metadata of .vdb files.
#include "io/vdb/bytes/vdb_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>

#include "io/vdb/vdb_transform.h"
#include "vog/error.h"

namespace vog::vdb {

namespace {

constexpr std::int64_t kMagic = 0x56444220;  // " BDV", then four zero bytes
constexpr std::uint32_t kFirstVersion = 222, kLastVersion = 225;
constexpr int kUuidBytes = 36;
constexpr char kNumberSeparator = '\x1e';  // between a name and the number that makes it unique
constexpr std::string_view kHalfSuffix = "_HalfFloat";
// Smallest grid descriptor: lengths of name, type and parent, and three positions.
constexpr std::uint64_t kMinEntryBytes = 3 * 4 + 3 * 8;

}  // namespace

VdbFile::VdbFile(const std::filesystem::path& file) : name_(file.string()), file_(file) {
    read_header();
    const auto count = file_.number<std::int32_t>();
    if (count < 0 || static_cast<std::uint64_t>(count) > file_.size() / kMinEntryBytes)
        file_.fail(fmt::format("corrupt: {} grids", count));
    for (int i = 0; i < count; ++i) {
        read_entry();
        file_.seek(entries_.back().end);
    }
}

void VdbFile::read_header() {
    if (file_.size() < sizeof kMagic || file_.number<std::int64_t>() != kMagic)
        throw Error(fmt::format("{}: not a VDB file", name_));
    version_ = file_.number<std::uint32_t>();
    if (version_ < kFirstVersion || version_ > kLastVersion)
        throw Error(fmt::format("{}: VDB file version {}, expected {} to {}", name_, version_,
                                kFirstVersion, kLastVersion));
    file_.take(2 * sizeof(std::uint32_t));  // version of the library that wrote it
    if (file_.number<char>() == 0)
        throw Error(
            fmt::format("{}: written as a stream, without the positions of its grids; expected a "
                        "file as openvdb::io::File writes it",
                        name_));
    file_.take(kUuidBytes);
    standing_ = read_vdb_metadata(file_).standing;
}

void VdbFile::read_entry() {
    VdbEntry entry;
    entry.unique_name = file_.string();
    const std::size_t separator = entry.unique_name.find(kNumberSeparator);
    entry.plain_name = grid_name(entry.unique_name.substr(0, separator));
    entry.name = entry.plain_name;
    if (separator != std::string::npos)
        entry.name += fmt::format("[{}]", grid_name(entry.unique_name.substr(separator + 1)));

    entry.tree_type = file_.string();
    entry.half_stored = entry.tree_type.ends_with(kHalfSuffix);
    if (entry.half_stored) entry.tree_type.resize(entry.tree_type.size() - kHalfSuffix.size());
    entry.parent = file_.string();

    const auto begin = file_.number<std::int64_t>();
    file_.take(sizeof(std::int64_t));  // position of the voxel values: check_tree finds it
    auto end = file_.number<std::int64_t>();
    // Some writers store 0 as the end of a single grid.
    if (end == 0 && entries_.empty()) end = static_cast<std::int64_t>(file_.size());
    if (begin < static_cast<std::int64_t>(file_.position()) || end < begin)
        file_.fail(fmt::format("corrupt: grid '{}' at bytes {} to {}", entry.name, begin, end));
    entry.begin = static_cast<std::uint64_t>(begin);
    entry.end = static_cast<std::uint64_t>(end);
    if (entry.end > file_.size())
        throw Error(fmt::format("{}: truncated: grid '{}' ends at byte {}, the file at {}", name_,
                                entry.name, entry.end, file_.size()));
    entries_.push_back(std::move(entry));
}

std::string VdbFile::where(const VdbEntry& entry) const {
    return fmt::format("{}: grid '{}'", name_, entry.name);
}

VdbHead read_vdb_head(ByteSource& in) {
    VdbHead head;
    head.compression = in.number<std::uint32_t>();
    if (head.compression > 7) in.fail(fmt::format("corrupt: compression {}", head.compression));
    head.metadata = read_vdb_metadata(in);
    head.grid_class = grid_name(head.metadata.grid_class);
    if (head.grid_class.empty()) head.grid_class = "unknown";
    head.world_from_index = read_transform(in);
    return head;
}

VdbMetadata read_vdb_metadata(ByteSource& in) {
    VdbMetadata metadata;
    const auto count = in.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count; ++i) {  // each takes at least 12 bytes, so this ends
        const std::string name = in.string();
        const std::string type = in.string();
        const std::string value = in.string();
        if (type == "string" && name == "class") metadata.grid_class = value;
        if (type == "string" && name == "vector_type") metadata.vector_type = value;
        if (type == "string" && (name == "unit" || name == "units"))
            metadata.unit = grid_name(value);
        if (type == "string" && name == "length_unit") metadata.length_unit = grid_name(value);
        // Blender names itself; Mantaflow states its resolution, writers of adaptive meshes the level.
        if ((name == "creator" && value.starts_with("Blender")) || name == "file_base_resolution" ||
            name == "amr_level")
            metadata.standing.up = {0, 0, 1};
        for (const auto& [key, direction] :
             {std::pair{"up", &metadata.standing.up}, {"front", &metadata.standing.front}})
            if (name == key && type == "vec3d" && value.size() == sizeof(Vec3d)) {
                Vec3d stated;
                std::memcpy(&stated, value.data(), sizeof(Vec3d));
                if (std::abs(length(stated) - 1) < 1e-6) *direction = stated;
            }
        if (type == "bool" && name == "is_local_space")
            metadata.local_space = !value.empty() && value.front() != 0;
    }
    return metadata;
}

}  // namespace vog::vdb
