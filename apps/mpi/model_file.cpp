// model_file.cpp: distributed models to PLY files.
#include "model_file.h"

#include <fmt/core.h>
#include <fmt/ranges.h>
#include <mpi.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>

#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/periodic.h"
#include "vog/ply.h"
#include "vog/temporary_file.h"

namespace vog::mpi {

namespace {

namespace fs = std::filesystem;

/// Totals over all ranks.
struct Sums {
    std::uint64_t count = 0;
    double mass = 0;
    bool rotated = false;
};

Sums sums_of(const SharedModel& model, const Ranks& ranks) {
    Sums sums;
    bool rotated = false;
    for (const Gaussians& part : model.inputs) {
        sums.count += part.size();
        sums.mass += mass_without_images(part);
        rotated |= !part.axis_aligned();
    }
    sums.count = ranks.sum(sums.count);
    ranks.sum(std::span(&sums.mass, 1));
    sums.rotated = ranks.sum(std::uint64_t{rotated}) > 0;
    return sums;
}

cli::Converted converted(const SharedModel& model, const Sums& sums, std::uint64_t bytes) {
    const Gaussians& about = model.description;
    return {about.method, about.options, about.summary,       sums.count, about.source_voxels, 0,
            bytes,        sums.mass,     about.fields.names()};
}

/// A file that all ranks write through MPI-IO.
class SharedFile {
  public:
    /// Opens a file that exists. Opening and closing are collective.
    /// name  of the file in messages
    SharedFile(const std::string& name, const std::string& file) : name_(name) {
        errno = 0;
        check(MPI_File_open(MPI_COMM_WORLD, file.c_str(), MPI_MODE_WRONLY, MPI_INFO_NULL, &file_));
    }
    ~SharedFile() {
        if (file_ != MPI_FILE_NULL) MPI_File_close(&file_);
    }
    SharedFile(const SharedFile&) = delete;
    SharedFile& operator=(const SharedFile&) = delete;

    /// Collective. throws vog::Error where a file system reports only here that it is full
    void close() {
        errno = 0;
        check(MPI_File_close(&file_));
    }
    void write(std::uint64_t offset, const void* bytes, std::size_t size) {
        MPI_Status status;
        errno = 0;
        check(MPI_File_write_at(file_, static_cast<MPI_Offset>(offset), bytes,
                                static_cast<int>(size), MPI_BYTE, &status));
        int written = 0;
        MPI_Get_count(&status, MPI_BYTE, &written);
        if (static_cast<std::size_t>(written) != size)
            fail(fmt::format("{} of {} bytes written, the disk may be full", written, size));
    }

  private:
    void check(int code) const {
        if (code == MPI_SUCCESS) return;
        char text[MPI_MAX_ERROR_STRING];
        int length = 0;
        MPI_Error_string(code, text, &length);
        fail(std::string(text, static_cast<std::size_t>(length)));
    }
    /// text  reason if the system has left none in errno
    [[noreturn]] void fail(const std::string& text) const {
        throw Error(fmt::format("{}: cannot write: {}", name_,
                                errno ? std::generic_category().message(errno) : text));
    }

    std::string name_;
    MPI_File file_ = MPI_FILE_NULL;
};

void write_rows(SharedFile& out, std::uint64_t offset, const Gaussians& part, bool rotated) {
    constexpr std::size_t kBlock = 1 << 16;
    for (std::size_t first = 0; first < part.size(); first += kBlock) {
        const std::size_t count = std::min(kBlock, part.size() - first);
        const std::vector<float> rows = ply_rows(part, first, count, rotated);
        out.write(offset, rows.data(), rows.size() * sizeof(float));
        offset += rows.size() * sizeof(float);
    }
}

}  // namespace

cli::Converted write_model(const std::string& file, const SharedModel& model, const Ranks& ranks) {
    const Fields& fields = model.description.fields;
    for (const Gaussians& part : model.inputs) {
        validate(part);
        if (part.size() > 0 && part.fields.names() != fields.names())
            throw Error(fmt::format("{}: fields {} in a part, expected those of the whole: {}",
                                    part.source, fmt::join(part.fields.names(), ", "),
                                    fmt::join(fields.names(), ", ")));
    }
    const Sums sums = sums_of(model, ranks);
    const std::string header = ranks.from_root(
        ranks.first() ? ply_header(model.description, sums.count, sums.rotated) : std::string());
    const std::uint64_t row_bytes = ply_row_floats(sums.rotated, fields) * sizeof(float);
    std::vector<std::uint64_t> offsets;
    std::uint64_t end = header.size();
    for (const Gaussians& part : model.inputs) {
        const std::vector<std::uint64_t> counts = ranks.gather(part.size());
        std::uint64_t offset = end;
        for (int rank = 0; rank < ranks.rank(); ++rank)
            offset += counts[static_cast<std::size_t>(rank)] * row_bytes;
        offsets.push_back(offset);
        for (const std::uint64_t count : counts) end += count * row_bytes;
    }

    // Created by the root, so that a folder without write access is one rank's failure.
    std::optional<TemporaryFile> beside;
    if (ranks.first()) beside.emplace(file);
    const std::string name =
        ranks.from_root(beside ? fs::absolute(beside->path()).string() : std::string());
    // Another folder under the name would take this rank's rows: the file's name is random.
    std::error_code code;
    if (!fs::exists(name, code))
        throw Error(fmt::format(
            "{}: the folder of the first rank is not there, expected one that all ranks share",
            file));
    ranks.agree();
    Failure failure;
    {
        SharedFile out(file, name);
        // A rank that fails still closes the file with the others, and reports after that.
        try {
            if (ranks.first()) out.write(0, header.data(), header.size());
            for (std::size_t n = 0; n < model.inputs.size(); ++n)
                write_rows(out, offsets[n], model.inputs[n], sums.rotated);
        } catch (const std::exception& error) {
            failure = {1, error.what()};
        }
        try {
            out.close();
        } catch (const std::exception& error) {
            if (failure.exit_code == 0) failure = {1, error.what()};
        }
    }
    ranks.agree(failure);
    if (beside) beside->rename();
    return converted(model, sums, end);
}

cli::Converted write_split(const std::string& file, const SharedModel& model, const Ranks& ranks) {
    const Sums sums = sums_of(model, ranks);
    Gaussians mine;
    for (const Gaussians& part : model.inputs) append(mine, part);
    // Every file's header describes the whole model, except for its own source voxels.
    const Gaussians& about = model.description;
    mine.box = about.box;
    mine.content = about.content;
    mine.source = ranks.from_root(about.source);
    mine.method = ranks.from_root(about.method);
    mine.options = ranks.from_root(about.options);
    mine.summary.clear();
    const fs::path path = file;
    const std::string name = fmt::format("{}.{}.ply", path.stem().string(), ranks.rank());
    std::uint64_t bytes = 0;
    if (mine.size() > 0) {
        write_ply(path.parent_path() / name, mine);
        bytes = ply_bytes(mine);
    }
    bytes = ranks.sum(bytes);
    std::vector<std::string> names = ranks.gather(mine.size() > 0 ? name : std::string());
    std::erase(names, std::string());
    if (ranks.first()) write_model_index(fs::path(path).replace_extension(".json"), names);
    return converted(model, sums, bytes);
}

}  // namespace vog::mpi
