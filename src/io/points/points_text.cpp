// points_text.cpp: parallel reading of particles from text, in chunks of whole lines.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <tbb/enumerable_thread_specific.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <ranges>
#include <utility>

#include "core/atomic_file.h"
#include "core/paging.h"
#include "core/parallel.h"
#include "io/file_extension.h"
#include "io/float_of.h"
#include "io/points/column_names.h"
#include "io/points/points_columns.h"
#include "io/points/points_files.h"
#include "io/points/text_fields.h"
#include "io/scan/scan_bytes.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::point_files {

namespace {

/// Text file with access to the lines in a range of bytes. Not memory-mapped: a file that shrinks
/// while it is read is then an error, not a signal.
class LineFile {
  public:
    explicit LineFile(const std::filesystem::path& file) : name_(file.string()) {
        require_readable(file);
        if (lower_extension(file) == ".gz") {
            unpack(file);
            return;
        }
        descriptor_ = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
        struct stat status {};
        if (descriptor_ < 0 || ::fstat(descriptor_, &status) != 0 || !S_ISREG(status.st_mode))
            throw Error(fmt::format("{}: cannot be read", name_));
        size_ = static_cast<std::uint64_t>(status.st_size);
    }
    ~LineFile() {
        if (descriptor_ >= 0) ::close(descriptor_);
    }
    LineFile(const LineFile&) = delete;
    LineFile& operator=(const LineFile&) = delete;

    std::uint64_t size() const { return size_; }
    const std::string& name() const { return name_; }

    /// Complete lines that start in bytes [begin, end); valid until `buffer` changes.
    std::string_view lines(std::uint64_t begin, std::uint64_t end,
                           std::vector<char>& buffer) const {
        // The bytes before `begin` and at `end` show whether lines start there.
        const std::uint64_t first = begin > 0 ? begin - 1 : 0;
        const std::uint64_t limit = std::min(end, size_) - first;
        buffer.resize(std::min(limit + 1, size_ - first));
        read(first, buffer.data(), buffer.size());
        const auto held = [&] { return std::string_view(buffer.data(), buffer.size()); };
        std::size_t start = begin - first;
        if (begin > 0)
            while (start < limit && !starts_line(held(), start)) ++start;
        if (start == limit) return {};
        // Appends the rest of the last line.
        std::size_t stop = limit;
        while (first + stop < size_ && !starts_line(held(), stop))
            if (++stop == buffer.size() && first + stop < size_) {
                constexpr std::uint64_t kStep = 4096;
                buffer.resize(stop + std::min(kStep, size_ - first - stop));
                read(first + stop, buffer.data() + stop, buffer.size() - stop);
            }
        const std::string_view text = held().substr(start, stop - start);
        return begin == 0 ? without_byte_order_mark(text) : text;
    }

  private:
    /// Reads the whole of a gzip'd text.
    void unpack(const std::filesystem::path& file) {
        if (!scan::is_gzip(file))
            throw Error(fmt::format("{}: not gzip, expected a packed text", name_));
        scan::ScanBytes bytes(file, 0, scan::Encoding::deflate);
        constexpr std::uint64_t kPiece = std::uint64_t{1} << 18;
        std::vector<char> piece(kPiece);
        while (const std::uint64_t got = bytes.read_some(piece.data(), kPiece)) {
            unpacked_.insert(unpacked_.end(), piece.begin(),
                             piece.begin() + static_cast<std::ptrdiff_t>(got));
            keep_memory();
        }
        size_ = unpacked_.size();
    }
    /// Spreadsheets put the mark before UTF-8 too, where it says nothing.
    std::string_view without_byte_order_mark(std::string_view text) const {
        if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
            throw Error(fmt::format("{}: text in UTF-16, expected UTF-8 or ASCII", name_));
        constexpr std::size_t kBegin = 64, kMostZeros = 3;
        if (text.starts_with("\x1f\x8b") ||
            std::ranges::count(text.substr(0, kBegin), '\0') > std::ptrdiff_t{kMostZeros})
            throw Error(
                fmt::format("{}: no text, or text in UTF-16; expected UTF-8 or ASCII (packed text "
                            "ends in .gz, a snapshot in .hdf5)",
                            name_));
        if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
        return text;
    }
    void read(std::uint64_t at, char* to, std::size_t count) const {
        if (descriptor_ < 0) {
            std::memcpy(to, unpacked_.data() + at, count);
            return;
        }
        while (count > 0) {
            const ssize_t got = ::pread(descriptor_, to, count, static_cast<off_t>(at));
            if (got < 0 && errno == EINTR) continue;
            if (got <= 0) throw Error(fmt::format("{}: cannot be read to its end", name_));
            at += static_cast<std::uint64_t>(got);
            to += got;
            count -= static_cast<std::size_t>(got);
        }
    }
    std::string name_;
    int descriptor_ = -1;  ///< -1: the text is in unpacked_
    BigVector<char> unpacked_{};
    std::uint64_t size_ = 0;
};

constexpr std::uint64_t kChunkBytes = std::uint64_t{1} << 20;

/// text  complete lines
std::uint64_t count_lines(std::string_view text) {
    if (text.empty()) return 0;
    std::uint64_t count = 1;
    for (std::size_t at = 1; at < text.size(); ++at) count += starts_line(text, at);
    return count;
}

/// Lines and results of a chunk of 1 MiB.
struct Chunk {
    std::uint64_t first_line = 0, line_count = 0;  ///< first_line from 0
    std::uint64_t particles = 0;                   ///< number read
    std::vector<std::uint64_t> bad_lines;          ///< numbers of malformed lines, from 0
    std::vector<double> largest;                   ///< [attributes], finite sizes
    std::string first_fault;                       ///< message about the first of them
};

/// Parses the particles of one chunk into their final arrays.
class ChunkReader {
  public:
    ChunkReader(const PointColumns& columns, Points& points, bool skip_nonfinite)
        : columns_(columns), points_(points), skip_nonfinite_(skip_nonfinite) {}

    void read(std::string_view text, Chunk& chunk) const {
        chunk.largest.assign(points_.attributes.size(), 0);
        for (std::uint64_t line = chunk.first_line; !text.empty(); ++line) {
            const std::string_view content = trimmed(take_line(text), columns_.separator);
            const bool comment = is_comment_or_empty(content, columns_.separator);
            if (line < columns_.first_line || (comment && !is_head(content))) continue;
            if (!comment &&
                read_particle(content, first_particle(chunk) + chunk.particles, chunk)) {
                ++chunk.particles;
                continue;
            }
            if (chunk.bad_lines.empty()) chunk.first_fault = fault(content);
            chunk.bad_lines.push_back(line);
        }
    }
    /// Index of a chunk's first particle if every line before it were one.
    std::uint64_t first_particle(const Chunk& chunk) const {
        return chunk.first_line < columns_.first_line ? 0 : chunk.first_line - columns_.first_line;
    }

  private:
    bool read_particle(std::string_view line, std::uint64_t n, Chunk& chunk) const;
    /// Whether a line names as many columns as there are.
    bool is_head(std::string_view line) const {
        const Fields names = header_fields(line, columns_.separator);
        return names.size() == columns_.role.size() && names_position(names);
    }
    std::string fault(std::string_view line) const;
    void put(int role, std::uint64_t n, double value, Chunk& chunk) const {
        if (role < kFirstVelocity) {
            points_.position[n][role] = value;
        } else if (role < kFirstAttribute) {
            points_.velocity[n][role - kFirstVelocity] = float_of(value);
        } else {
            const auto k = static_cast<std::size_t>(role - kFirstAttribute);
            PointAttribute& attribute = points_.attributes[k];
            attribute.value[n] = float_of(value, attribute.unit);
            if (std::isfinite(value))
                chunk.largest[k] = std::max(chunk.largest[k], std::abs(value));
        }
    }
    /// Number of a field; NaN for a missing one behind the position.
    static bool parse(int role, std::string_view field, double& value) {
        const bool number = parse_number(field, value);
        const bool missing = !number && role >= kFirstVelocity && is_missing(field);
        if (!number && !missing) return false;
        if (missing || std::isnan(value)) value = std::numeric_limits<double>::quiet_NaN();
        return true;
    }
    bool fits(int role, double value) const {
        if (skip_nonfinite_) return true;  // left out when all are read
        if (role < kFirstVelocity) return std::isfinite(value);
        return role < kFirstAttribute ? !(std::abs(value) > kLargest) : !std::isinf(value);
    }
    static constexpr double kLargest = std::numeric_limits<float>::max();

    const PointColumns& columns_;
    Points& points_;
    bool skip_nonfinite_;
};

bool ChunkReader::read_particle(std::string_view line, std::uint64_t n, Chunk& chunk) const {
    bool ends_open = columns_.separator && line.ends_with(columns_.separator);
    for (const int role : columns_.role) {
        if (line.empty() && !std::exchange(ends_open, false)) return false;
        const std::string_view field = take_field(line, columns_.separator);
        if (role == kSkipped) continue;
        double value;
        if (!parse(role, field, value)) return false;
        if (role < kFirstAttribute) value *= columns_.factor[static_cast<std::size_t>(role)];
        if (!fits(role, value)) return false;
        put(role, n, value, chunk);
    }
    // Separators may follow the last column.
    while (!line.empty())
        if (!take_field(line, columns_.separator).empty()) return false;
    return true;
}

/// Message about a line for which read_particle returned false.
std::string ChunkReader::fault(std::string_view line) const {
    const auto fields = split_fields(line, columns_.separator);
    if (columns_.count && fields.size() == 1 && line.find_first_not_of("0123456789") == line.npos)
        return "a second count: several frames, expected one";
    if (is_head(line)) return "a second line of names: give joined files one by one";
    const bool longer = std::ranges::any_of(
        fields | std::views::drop(std::min(fields.size(), columns_.role.size())),
        [](std::string_view field) { return !field.empty(); });
    if (fields.size() < columns_.role.size() || longer)
        return fmt::format("got {} columns, expected {}", fields.size(), columns_.role.size());
    for (std::size_t column = 0; column < columns_.role.size(); ++column) {
        const int role = columns_.role[column];
        double value;
        if (role == kSkipped) continue;
        constexpr std::size_t kShown = 40;
        const std::string text(fields[column].substr(0, kShown));
        if (has_decimal_comma(fields[column]))
            return fmt::format("got '{}' in column {}, a decimal comma; expected decimal points",
                               text, column + 1);
        if (!parse(role, fields[column], value))
            return fmt::format("got '{}' in column {}, expected a number", text, column + 1);
        if (!fits(role, value))
            return fmt::format(
                "got '{}' in column {}, expected a finite number (--skip-nonfinite leaves such "
                "particles out)",
                text, column + 1);
    }
    return "malformed";
}

/// throws vog::Error with the numbers of malformed lines, and the reason for the first
[[noreturn]] void throw_malformed(const std::string& name, const std::vector<Chunk>& chunks) {
    constexpr std::size_t kListed = 20;
    std::string message, others;
    std::size_t count = 0;
    for (const Chunk& chunk : chunks)
        for (const std::uint64_t line : chunk.bad_lines) {
            if (count == 0)
                message = fmt::format("{}:{}: {}", name, line + 1, chunk.first_fault);
            else if (count <= kListed)
                others += fmt::format("{}{}", count == 1 ? "" : ", ", line + 1);
            ++count;
        }
    if (count == 2) message += fmt::format("; also malformed: line {}", others);
    if (count > 2)
        message += fmt::format("; also malformed: {} lines: {}{}", count - 1, others,
                               count > kListed + 1 ? ", ..." : "");
    throw Error(message);
}

void resize(Points& points, std::uint64_t count, const PointColumns& columns) {
    resize_kept(points.position, count);
    if (columns.has_velocity) resize_kept(points.velocity, count);
    for (PointAttribute& attribute : points.attributes) resize_kept(attribute.value, count);
}

/// Closes the gaps that comments and empty lines left between the chunks' particles.
void close_gaps(Points& points, const std::vector<Chunk>& chunks, const ChunkReader& reader) {
    const auto close = [&](auto& values) {
        if (values.empty()) return;
        auto to = values.begin();
        for (const Chunk& chunk : chunks) {
            const auto from =
                values.begin() + static_cast<std::ptrdiff_t>(reader.first_particle(chunk));
            const auto count = static_cast<std::ptrdiff_t>(chunk.particles);
            to = to == from ? from + count : std::move(from, from + count, to);
            keep_memory();
        }
    };
    close(points.position);
    close(points.velocity);
    for (PointAttribute& attribute : points.attributes) close(attribute.value);
}

/// Reader of one file: the layout of its lines, then its particles.
class TextReader {
  public:
    TextReader(const std::filesystem::path& path, const PointReadOptions& options)
        : path_(path),
          options_(options),
          file_(path),
          chunks_((file_.size() + kChunkBytes - 1) / kChunkBytes) {}

    Points read(std::string* note) {
        const std::string_view text = head();
        vog::parallel_for(std::size_t{0}, chunks_.size(),
                          [&](std::size_t n) { chunks_[n].line_count = count_lines(lines_of(n)); });
        for (std::size_t n = 1; n < chunks_.size(); ++n)
            chunks_[n].first_line = chunks_[n - 1].first_line + chunks_[n - 1].line_count;
        PointColumns columns = find_columns(path_, text, options_);
        Points points = read_particles(columns);
        if (columns.may_be_title && points.size() == *columns.count + 1)
            points = read_particles(columns = find_columns(path_, head(), options_, true));
        if (columns.count && points.size() != *columns.count)
            throw Error(fmt::format("{}:{}: a count of {}, but {} particles follow", file_.name(),
                                    columns.count_line + 1, *columns.count, points.size()));
        if (note && !columns.note.empty())
            *note = fmt::format("{}: {}", points.source, columns.note);
        return points;
    }

  private:
    std::string_view head() {
        constexpr std::uint64_t kHeadBytes = std::uint64_t{1} << 20;
        return file_.size() ? file_.lines(0, kHeadBytes, head_) : "";
    }
    std::string_view lines_of(std::size_t n) {
        return file_.lines(n * kChunkBytes, (n + 1) * kChunkBytes, buffers_.local());
    }
    Points read_particles(const PointColumns& columns) {
        Points points;
        points.source = printable(path_.string());
        points.length_unit = columns.length_unit;
        points.velocity_unit = columns.velocity_unit;
        for (std::size_t k = 0; k < columns.attributes.size(); ++k)
            points.attributes.push_back({columns.attributes[k], {}, 1, columns.attribute_units[k]});
        const std::uint64_t lines = chunks_.back().first_line + chunks_.back().line_count;
        resize(points, lines - columns.first_line, columns);
        const ChunkReader reader(columns, points, options_.values.skip_nonfinite);
        read_chunks(reader);
        // Attributes beyond or below float's range are read again in a unit of their size.
        bool again = false;
        for (std::size_t k = 0; k < points.attributes.size(); ++k) {
            double largest = 0;
            for (const Chunk& chunk : chunks_) largest = std::max(largest, chunk.largest[k]);
            again |= (points.attributes[k].unit = float_unit(largest)) != 1;
        }
        if (again) read_chunks(reader);
        close_gaps(points, chunks_, reader);
        std::uint64_t particles = 0;
        for (const Chunk& chunk : chunks_) particles += chunk.particles;
        resize(points, particles, columns);
        return points;
    }
    void read_chunks(const ChunkReader& reader) {
        vog::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t n) {
            Chunk& chunk = chunks_[n];
            chunk.particles = 0;
            reader.read(lines_of(n), chunk);
        });
        for (const Chunk& chunk : chunks_)
            if (!chunk.bad_lines.empty()) throw_malformed(file_.name(), chunks_);
    }

    const std::filesystem::path& path_;
    const PointReadOptions& options_;
    const LineFile file_;
    std::vector<Chunk> chunks_;
    std::vector<char> head_{};
    tbb::enumerable_thread_specific<std::vector<char>> buffers_{};
};

}  // namespace

Points read_points_text(const std::filesystem::path& path, const PointReadOptions& options,
                        std::string* note) {
    return TextReader(path, options).read(note);
}

}  // namespace vog::point_files
