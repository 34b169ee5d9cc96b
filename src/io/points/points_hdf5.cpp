// points_hdf5.cpp: particles of snapshots in HDF5, in the layout of Gadget, Arepo, Gizmo and SWIFT.
#include <fmt/ranges.h>

#include "io/file_extension.h"
#include "io/points/points_files.h"
#include "io/points/snapshot_units.h"
#include "vog/error.h"
#include "vog/text.h"

#ifdef VOG_HDF5
#include <hdf5.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <set>

#include "core/atomic_file.h"
#include "core/paging.h"
#include "io/float_of.h"
#endif

namespace vog::point_files {

bool is_hdf5(const std::filesystem::path& file) {
    const std::string extension = lower_extension(file);
    return extension == ".hdf5" || extension == ".h5" || extension == ".hdf";
}

#ifndef VOG_HDF5

Points read_points_hdf5(const std::filesystem::path& file, const PointReadOptions&) {
    throw Error(fmt::format("{}: this build reads no HDF5 (libhdf5 was absent when it was built)",
                            file.string()));
}
ParticleTypes types_of_hdf5(const std::filesystem::path& file) {
    read_points_hdf5(file, {});
    return {};
}
SnapshotPart part_of_hdf5(const std::filesystem::path&, const std::string&) { return {}; }

#else

namespace {

/// Identifier that is closed with its kind's function.
class Handle {
  public:
    Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    operator hid_t() const { return id_; }
    bool good() const { return id_ >= 0; }

  private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

/// Keeps the library from printing; restores its printer.
class Silence {
  public:
    Silence() {
        H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
    Silence(const Silence&) = delete;
    Silence& operator=(const Silence&) = delete;

  private:
    H5E_auto2_t function_ = nullptr;
    void* data_ = nullptr;
};

/// Array of a group: its rows and components, 1 for a single number a particle.
struct Array {
    std::string name;
    hsize_t rows = 0, components = 1;
    bool number = false;  ///< integers or floats
    bool is_position() const {
        return name == "Coordinates" && number && components == 3 && rows > 0;
    }
};

std::vector<std::string> members(hid_t group) {
    std::vector<std::string> names;
    H5Literate(
        group, H5_INDEX_NAME, H5_ITER_NATIVE, nullptr,
        [](hid_t, const char* name, const H5L_info_t*, void* list) -> herr_t {
            static_cast<std::vector<std::string>*>(list)->emplace_back(name);
            return 0;
        },
        &names);
    return names;
}

bool is_dataset(hid_t group, const std::string& name) {
    H5O_info_t info;
    return H5Oget_info_by_name(group, name.c_str(), &info, H5P_DEFAULT) >= 0 &&
           info.type == H5O_TYPE_DATASET;
}

/// A snapshot file, and the group of one type of particles.
class Snapshot {
  public:
    explicit Snapshot(const std::filesystem::path& path)
        : path_(path),
          name_(path.string()),
          file_(H5Fopen(name_.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose) {
        if (!file_.good()) fail("not HDF5, or corrupt");
        for (const std::string& name : members(file_)) {
            if (!name.starts_with("PartType") || name.size() != 9 || name[8] < '0' || name[8] > '9')
                continue;
            groups_.push_back(name);
            try {
                open(name);
                const auto place = std::ranges::find_if(arrays_, &Array::is_position);
                if (place == arrays_.end()) {
                    if (std::ranges::any_of(arrays_, [](const Array& a) { return a.rows > 0; }))
                        unplaced_.push_back(name);
                    continue;
                }
                types_.particles.push_back(static_cast<double>(place->rows));
            } catch (const Error&) {  // reported when the type is chosen
                types_.particles.push_back(0);
            }
            types_.name.push_back(name);
        }
    }

    /// Types of particles that have positions.
    const ParticleTypes& types() const { return types_; }
    /// Opens the type that is requested, or meant.
    void choose(const std::string& requested, bool refuse = false) {
        if (types_.name.empty())
            fail(groups_.empty() ? "no group PartType0 to PartType9"
                                 : "no type with particles: Coordinates of 3 numbers each");
        if (const std::string& meant = requested.empty() ? groups_.front() : requested;
            std::ranges::count(unplaced_, meant))
            throw Error(
                fmt::format("{}: {} has arrays, but no Coordinates of 3 numbers each; expected "
                            "them, or another type by --grid (it has: {})",
                            name_, meant, fmt::join(types_.name, ", ")));
        if (requested.empty()) return open(types_.name[likely_type(name_, types_, refuse).index]);
        if (std::ranges::count(types_.name, requested)) return open(requested);
        throw Error(fmt::format("{}: {}; choose one with --grid (it has: {})", name_,
                                std::ranges::count(groups_, requested)
                                    ? fmt::format("{} has no particles", requested)
                                    : fmt::format("no particles '{}'", printable(requested)),
                                fmt::join(types_.name, ", ")));
    }
    const std::vector<Array>& arrays() const { return arrays_; }
    /// Positions of the chosen type.
    const Array& position() const { return *std::ranges::find_if(arrays_, &Array::is_position); }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format(
            "{}: {}, expected a snapshot with PartType0/Coordinates or the like", name_, what));
    }
    const std::string& group_name() const { return group_name_; }

    /// Reads an array as doubles or floats, by its memory type.
    template <class T>
    void read(const Array& array, hid_t memory_type, T* to) const {
        const Handle set(H5Dopen2(*group_, array.name.c_str(), H5P_DEFAULT), H5Dclose);
        if (!set.good() || H5Dread(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, to) < 0)
            fail(fmt::format("'{}/{}' is corrupt, or packed by an unknown filter", group_name_,
                             printable(array.name)));
    }
    /// Number in Header, or the chosen type's in an array; none where the header lacks it.
    std::optional<double> stated(const char* name) const {
        const std::vector<double> numbers = header(name);
        const std::size_t type =
            numbers.size() == 1 ? 0 : static_cast<std::size_t>(group_name_.back() - '0');
        if (type >= numbers.size()) return {};
        return numbers[type];
    }
    /// Numbers in Header; none where the header lacks them.
    std::vector<double> header(const char* name) const { return numbers_of("Header", name); }
    /// Unit of an array's numbers; empty: not known.
    std::string unit_of(const Array& array) const {
        const std::string path = group_name_ + "/" + array.name;
        const AttributeReader own = [&](const char* name) { return first_number(path, name); };
        const AttributeReader common = [&](const char* name) {
            std::optional<double> found;
            for (const char* group : {"Units", "Header", "Parameters"})
                if (!found) found = first_number(group, name);
            return found;
        };
        for (const char* name : {"units", "unit"})
            if (const std::string text = text_of(path, name); !text.empty())
                return printable(text, 40);
        return snapshot_unit(array.name, own, common);
    }
    SnapshotPart part() const {
        constexpr double kHighWord = 4294967296.0;
        return {stated("NumFilesPerSnapshot").value_or(1),
                stated("NumPart_Total").value_or(0) +
                    kHighWord * stated("NumPart_Total_HighWord").value_or(0)};
    }

  private:
    /// Numbers of an attribute of a group or an array; none: it has none.
    std::vector<double> numbers_of(const std::string& object, const char* name) const {
        const Handle table(H5Aopen_by_name(file_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
        if (!table.good()) return {};
        const Handle space(H5Aget_space(table), H5Sclose);
        constexpr hssize_t kMostTypes = 64;
        const hssize_t count = H5Sget_simple_extent_npoints(space);
        if (count < 1 || count > kMostTypes) return {};
        std::vector<double> numbers(static_cast<std::size_t>(count));
        if (H5Aread(table, H5T_NATIVE_DOUBLE, numbers.data()) < 0) return {};
        return numbers;
    }
    std::optional<double> first_number(const std::string& object, const char* name) const {
        const std::vector<double> numbers = numbers_of(object, name);
        if (numbers.size() != 1 || !std::isfinite(numbers[0])) return {};
        return numbers[0];
    }
    /// Text of an attribute, of fixed or any length; empty: it has none.
    std::string text_of(const std::string& object, const char* name) const {
        const Handle table(H5Aopen_by_name(file_, object.c_str(), name, H5P_DEFAULT, H5P_DEFAULT),
                           H5Aclose);
        if (!table.good()) return {};
        const Handle type(H5Aget_type(table), H5Tclose), space(H5Aget_space(table), H5Sclose);
        constexpr std::size_t kMostLetters = 256;
        if (H5Tget_class(type) != H5T_STRING || H5Sget_simple_extent_npoints(space) != 1) return {};
        if (H5Tis_variable_str(type) > 0) {
            char* text = nullptr;
            if (H5Aread(table, type, &text) < 0 || !text) return {};
            std::string copy = text;
            H5free_memory(text);
            return copy;
        }
        std::string text(H5Tget_size(type), '\0');
        if (text.size() > kMostLetters || H5Aread(table, type, text.data()) < 0) return {};
        return text.substr(0, text.find('\0'));
    }
    void open(const std::string& type) {
        group_name_ = type;
        group_.emplace(H5Gopen2(file_, type.c_str(), H5P_DEFAULT), H5Gclose);
        if (!group_->good()) fail(fmt::format("group '{}' cannot be read", type));
        arrays_.clear();
        for (const std::string& name : members(*group_))
            if (is_dataset(*group_, name)) arrays_.push_back(described(name));
    }
    /// Bytes of the files that an array is stored in: this one, or those that a virtual array refers to.
    double stored_bytes(hid_t set, const std::string& name) const {
        auto bytes = static_cast<double>(std::filesystem::file_size(path_));
        const Handle layout(H5Dget_create_plist(set), H5Pclose);
        if (H5Pget_layout(layout) != H5D_VIRTUAL) return bytes;
        std::size_t sources = 0;
        H5Pget_virtual_count(layout, &sources);
        std::set<std::string> names;
        for (std::size_t n = 0; n < sources; ++n) {
            std::string source(4096, '\0');
            H5Pget_virtual_filename(layout, n, source.data(), source.size());
            names.insert(source.c_str());
        }
        for (const std::string& source : names) {
            // "%b" counts blocks. The library looks beside the file, then in the working folder; what it cannot find is filled.
            if (source == "." || source.find("%b") != source.npos) continue;
            std::filesystem::path part = path_.parent_path() / source;
            std::error_code code;
            if (!std::filesystem::exists(part, code)) part = source;
            if (!std::filesystem::exists(part, code))
                throw Error(fmt::format("{}: '{}/{}' lies in {}, which is not there", name_,
                                        group_name_, printable(name), printable(source)));
            bytes += static_cast<double>(std::filesystem::file_size(part, code));
        }
        return bytes;
    }
    /// Shape and type of an array. Its size is checked against the file before memory is allocated.
    Array described(const std::string& name) const {
        Array array;
        array.name = name;
        const Handle set(H5Dopen2(*group_, name.c_str(), H5P_DEFAULT), H5Dclose);
        if (!set.good()) return array;
        const Handle space(H5Dget_space(set), H5Sclose), type(H5Dget_type(set), H5Tclose);
        const int rank = H5Sget_simple_extent_ndims(space);
        hsize_t size[2] = {0, 1};
        if (rank < 1 || rank > 2) return array;
        H5Sget_simple_extent_dims(space, size, nullptr);
        const H5T_class_t kind = H5Tget_class(type);
        array.number = kind == H5T_INTEGER || kind == H5T_FLOAT;
        array.rows = size[0];
        array.components = size[1];
        // Deflate's largest ratio is 1032; shuffled constants come near. Chunks that were never written hold the fill value.
        constexpr double kMostRatio = 1100;
        const double values = static_cast<double>(size[0]) * static_cast<double>(size[1]);
        if (array.number && values > kMostRatio * stored_bytes(set, name))
            fail(fmt::format("'{}/{}' has {} x {} values, more than the file holds", group_name_,
                             printable(name), size[0], size[1]));
        return array;
    }

    std::filesystem::path path_;
    std::string name_;
    Handle file_;
    std::vector<std::string> groups_;    ///< PartType0 to PartType9
    std::vector<std::string> unplaced_;  ///< those with arrays, but without positions
    ParticleTypes types_;
    std::string group_name_;
    std::optional<Handle> group_;
    std::vector<Array> arrays_;
};

/// Values of an array, one a particle: numbers, or lengths of vectors of three.
PointAttribute attribute_of(const Snapshot& snapshot, const Array& array) {
    BigVector<double> numbers;
    resize_kept(numbers, array.rows * array.components);
    snapshot.read(array, H5T_NATIVE_DOUBLE, numbers.data());
    double largest = 0;
    for (std::size_t n = 0; n < array.rows; ++n) {
        if (array.components == 3)
            numbers[n] = length(Vec3d{numbers[3 * n], numbers[3 * n + 1], numbers[3 * n + 2]});
        if (std::isfinite(numbers[n])) largest = std::max(largest, std::abs(numbers[n]));
    }
    PointAttribute attribute{
        printable(array.name), {}, float_unit(largest), snapshot.unit_of(array)};
    resize_kept(attribute.value, array.rows);
    for (std::size_t n = 0; n < array.rows; ++n)
        attribute.value[n] = float_of(numbers[n], attribute.unit);
    return attribute;
}

Points points_of(const Snapshot& snapshot, const std::filesystem::path& file) {
    const Array* place = &snapshot.position();
    if (place->rows > std::numeric_limits<std::int32_t>::max())
        snapshot.fail(fmt::format("{} particles in '{}'", place->rows, snapshot.group_name()));
    if (const auto rows = snapshot.stated("NumPart_ThisFile");
        rows && *rows != static_cast<double>(place->rows))
        throw Error(
            fmt::format("{}: {} rows of {}/Coordinates, but Header/NumPart_ThisFile states {} "
                        "particles, expected equal numbers",
                        file.string(), place->rows, snapshot.group_name(), *rows));
    Points points;
    points.source = printable(file.string());
    const std::vector<double> edges = snapshot.header("BoxSize");
    // Runs without a box state 0.
    if ((edges.size() == 1 || edges.size() == 3) &&
        std::ranges::all_of(edges, [](double edge) { return edge > 0 && std::isfinite(edge); }))
        points.box = {{}, {edges.front(), edges[edges.size() / 2], edges.back()}};
    static_assert(sizeof(Vec3d) == 3 * sizeof(double));
    resize_kept(points.position, place->rows);
    snapshot.read(*place, H5T_NATIVE_DOUBLE, points.position.data());
    points.length_unit = snapshot.unit_of(*place);
    bool has_mass = false;
    for (const Array& array : snapshot.arrays()) {
        // Numbers of particles are no quantity.
        if (&array == place || !array.number || array.name == "ParticleIDs") continue;
        if (array.components != 1 && array.components != 3) continue;
        if (array.rows != place->rows)
            snapshot.fail(fmt::format("'{}/{}' has {} rows for {} particles", snapshot.group_name(),
                                      printable(array.name), array.rows, place->rows));
        // EAGLE's names are singular.
        if ((array.name == "Velocities" || array.name == "Velocity") && array.components == 3) {
            resize_kept(points.velocity, place->rows);
            snapshot.read(array, H5T_NATIVE_FLOAT, points.velocity.data());
            points.velocity_unit = snapshot.unit_of(array);
            continue;
        }
        has_mass |= array.name == "Masses" || array.name == "Mass";
        points.attributes.push_back(attribute_of(snapshot, array));
    }
    if (const double mass = has_mass ? 0 : snapshot.stated("MassTable").value_or(0); mass > 0) {
        const double unit = float_unit(mass);
        points.attributes.push_back({"Masses", BigVector<float>(place->rows, float_of(mass, unit)),
                                     unit, snapshot.unit_of({.name = "Masses"})});
    }
    return points;
}

/// run(snapshot), one at a time: Debian's library is not built for several threads.
template <class Run>
auto with_snapshot(const std::filesystem::path& file, const Run& run) {
    static std::mutex one_at_a_time;
    const std::lock_guard lock(one_at_a_time);
    // Objects of a corrupt file may stay open; libhdf5 would print a line on them when the process ends.
    static const herr_t quiet_exit = H5dont_atexit();
    static_cast<void>(quiet_exit);  // negative where libhdf5 was in use before: its user closes it
    require_readable(file);
    const Silence silence;
    try {
        Snapshot snapshot(file);
        return run(snapshot);
    } catch (const std::bad_alloc&) {
        throw Error(fmt::format("{}: not enough memory", file.string()));
    } catch (const std::length_error&) {
        throw Error(fmt::format("{}: not enough memory", file.string()));
    }
}

}  // namespace

ParticleTypes types_of_hdf5(const std::filesystem::path& file) {
    return with_snapshot(file, [](const Snapshot& snapshot) { return snapshot.types(); });
}

SnapshotPart part_of_hdf5(const std::filesystem::path& file, const std::string& type) {
    return with_snapshot(file, [&](Snapshot& snapshot) {
        snapshot.choose(type);
        return snapshot.part();
    });
}

Points read_points_hdf5(const std::filesystem::path& file, const PointReadOptions& options) {
    return with_snapshot(file, [&](Snapshot& snapshot) {
        snapshot.choose(options.grid, options.refuse_several);
        return points_of(snapshot, file);
    });
}

#endif

}  // namespace vog::point_files
