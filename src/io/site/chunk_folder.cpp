// chunk_folder.cpp: files under the names of their content; one that is there is not written again.
#include "io/site/chunk_folder.h"

#include <span>

#include "core/atomic_file.h"
#include "io/site/chunk_name.h"

namespace vog::site {

namespace fs = std::filesystem;

/// Writes a file of the folder of chunks unless it is there. returns whether it was
bool ChunkFolder::put(const fs::path& file, const std::string& bytes) {
    {
        const std::lock_guard lock(mutex_);
        if (!files_.insert(file.filename().string()).second) return true;
    }
    std::error_code code;
    const bool there = fs::is_regular_file(file, code) && fs::file_size(file, code) == bytes.size();
    if (!there) write_file(file, [&](std::ofstream& out) { out << bytes; });
    const std::lock_guard lock(mutex_);
    bytes_ += bytes.size();
    return there;
}

void ChunkFolder::write_chunk(Row& row, const std::vector<std::string>& contents) {
    row.name = content_name(contents);
    // The shapes come last: a chunk that has them is whole.
    bool there = true;
    for (std::size_t k = contents.size(); k-- > 0;) {
        const fs::path file =
            k == 0 ? shapes_path(site_, row.name) : field_path(site_, row.name, k - 1);
        there = put(file, contents[k]) && there;
    }
    for (const std::string& content : contents)
        row.bytes.push_back(static_cast<std::uint32_t>(content.size()));
    const std::lock_guard lock(mutex_);
    kept_ += there ? 1 : 0;
}

void ChunkFolder::write_table(Row& row) {
    const std::string text = table_text(row.parts);
    row.table = content_name(std::span(&text, 1));
    row.table_bytes = static_cast<std::uint32_t>(text.size());
    put(table_path(site_, row.table), text);
    row.parts.clear();
}

}  // namespace vog::site
