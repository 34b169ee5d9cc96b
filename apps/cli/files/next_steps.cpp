// next_steps.cpp: command lines that fit grids, particles and models.
#include "files/next_steps.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "vog/site.h"

namespace vog::cli {

namespace {

namespace fs = std::filesystem;

/// Types of grids with one number a voxel.
bool is_scalar_grid(const VolumeInfo& volume) {
    const std::string& type = volume.grid.type;
    return !volume.grid.points && !type.starts_with("vec") && type != "string";
}

/// Name of an output beside nothing else: smoke.ply of data/smoke.vdb, in the working folder.
std::string beside_name(const std::string& file, const std::string& extension) {
    fs::path name = fs::path(file).filename();
    if (!name.has_filename()) name = fs::path(file).parent_path().filename();  // of a folder
    fs::path stem = name.stem();
    if (name.extension() == ".gz" || name.extension() == ".fz") stem = stem.stem();
    return stem.string() + extension;
}
std::string beside(const std::string& file, const std::string& extension) {
    return quoted(beside_name(file, extension));
}

/// Steps of a grid, or of the levels of one mesh.
/// grid  option that chooses it, with a space before; empty: the default
std::vector<NextStep> steps_of_grid(const std::string& name, const VolumeInfo& volume,
                                    const std::string& grid) {
    const std::string file = quoted(name) + grid, ply = beside(name, ".ply");
    const std::string png = beside(name, ".png"), html = beside(name, ".html");
    if (volume.grid.grid_class == "level set")
        return {{fmt::format("vog render {} --level-set-to-fog -o {}", file, png),
                 "a picture of the inside of the surface"},
                {fmt::format("vog convert {} --level-set-to-fog -o {}", file, ply), "Gaussians"}};
    // Signed values are no density: they are drawn by value, and become a field of Gaussians that count volume.
    if (volume.grid.min < 0 && volume.background == 0)
        return {{fmt::format("vog render {} -o {} --show volume", file, png),
                 "a volume picture; --window CENTRE,WIDTH chooses values"},
                {fmt::format("vog convert {} -o {} --measure volume", file, ply),
                 "Gaussians that carry the values, positive and negative"},
                {fmt::format("vog page {} -o {} --show volume", ply, html),
                 "then a page for a browser"},
                {fmt::format("vog view {} --show volume", ply), "or a window"},
                {fmt::format("vog render {} -o {} --clip-negative", file, png),
                 "a picture of the positive values as a density"}};
    return {{fmt::format("vog render {} -o {}", file, png), "a picture"},
            {fmt::format("vog render {} -o {} --show volume", file, png),
             "the same as a volume picture"},
            {fmt::format("vog convert {} -o {}", file, ply), "Gaussians"},
            {fmt::format("vog page {} -o {}", file, html), "a page for a browser"},
            {fmt::format("vog view {}", file), "a window"}};
}

std::vector<NextStep> steps_of_volume(const FileContents& contents) {
    std::vector<const VolumeInfo*> scalar;
    std::vector<std::string> names;
    for (const VolumeInfo& volume : contents.grids) {
        if (!is_scalar_grid(volume) || !volume.grid.affine || !volume.grid.active_voxels) continue;
        scalar.push_back(&volume);
        names.push_back(volume.grid.name);
    }
    const auto of_grid = [&](const VolumeInfo& volume, const std::string& name) {
        return steps_of_grid(contents.file, volume, " --grid " + quoted(name));
    };
    if (scalar.empty()) {
        for (const VolumeInfo& volume : contents.grids)
            if (volume.grid.type.starts_with("vec") && volume.grid.active_voxels)
                return of_grid(volume, volume.grid.name);
        return {};
    }
    const std::string pattern = level_pattern(names);
    if (!pattern.empty()) return of_grid(*scalar.front(), pattern);
    const auto density = std::ranges::find(names, "density");
    const bool named = names.size() > 1 && density == names.end();
    const auto chosen = density == names.end() ? 0 : density - names.begin();
    const VolumeInfo& volume = *scalar[static_cast<std::size_t>(chosen)];
    std::vector<NextStep> steps =
        named ? of_grid(volume, volume.grid.name) : steps_of_grid(contents.file, volume, "");
    // A second grid of a file is most often a field of the first.
    if (names.size() > 1 && volume.grid.min >= 0 && volume.grid.grid_class != "level set") {
        const std::string& other = names[chosen == 0 ? 1 : 0];
        steps.push_back(
            {fmt::format("vog convert {} --grid {} -o {} --field {}", quoted(contents.file),
                         quoted(volume.grid.name), beside(contents.file, ".ply"), quoted(other)),
             fmt::format("Gaussians that carry {} too", other)});
    }
    return steps;
}

std::vector<NextStep> steps_of_model(const FileContents& contents) {
    const std::string file =
        quoted(contents.file) + (contents.nonfinite ? " --skip-nonfinite" : "");
    const std::string png = beside(contents.file, ".png");
    // The optical depth of a model of volume is its thickness: its values are the picture.
    const std::string by_value = contents.measures_volume ? " --show volume" : "";
    std::vector<NextStep> steps{{fmt::format("vog render {} -o {}{}", file, png, by_value),
                                 by_value.empty() ? "a picture" : "a volume picture"}};
    if (!contents.fields.empty() && by_value.empty())
        steps.push_back({fmt::format("vog render {} -o {} --show volume --field {}", file, png,
                                     quoted(contents.fields.front())),
                         fmt::format("a picture by the value of {}", contents.fields.front())});
    steps.push_back(
        {fmt::format("vog page {} -o {}{}", file, beside(contents.file, ".html"), by_value),
         "a page for a browser"});
    steps.push_back({fmt::format("vog pack {} -o {}", file, beside(contents.file, "-small.vogz")),
                     "a compact model"});
    steps.push_back({fmt::format("vog view {}{}", file, by_value), "a window"});
    return steps;
}

std::vector<NextStep> steps_of_points(const FileContents& contents) {
    // Types of a snapshot, or grids of points of a .vdb.
    std::vector<std::string> types = contents.particle_types;
    for (const VolumeInfo& grid : contents.grids)
        if (grid.grid.points) types.push_back(grid.grid.name);
    if (types.size() == 1) types.clear();
    const std::string png = beside(contents.file, ".png");
    const auto of_type = [&](const std::string& type) {
        return quoted(contents.file) + (type.empty() ? "" : " --grid " + quoted(type)) +
               (contents.nonfinite ? " --skip-nonfinite" : "");
    };
    const std::string file = of_type(types.empty() ? "" : types.front());
    std::vector<NextStep> steps{
        {fmt::format("vog render {} -o {}", file, png),
         types.empty() ? "a picture" : "a picture of " + types.front()},
        {fmt::format("vog convert {} -o {} --budget 10000", file, beside(contents.file, ".ply")),
         "at most 10,000 Gaussians"},
        {fmt::format("vog page {} -o {}", file, beside(contents.file, ".html")),
         "a page for a browser"},
        {fmt::format("vog view {}", file), "a window"}};
    if (types.size() > 1)
        steps.push_back({fmt::format("vog render {} -o {}", of_type(types[1]),
                                     beside(contents.file, "-" + types[1] + ".png")),
                         "a picture of " + types[1]});
    return steps;
}

/// Contents of a JSON file; discarded where it is none.
nlohmann::json json_of(const std::string& file) {
    std::ifstream in(file);
    return nlohmann::json::parse(in, nullptr, false);
}

}  // namespace

std::string quoted(const std::string& word) {
    const auto plain = [](unsigned char letter) {
        return std::isalnum(letter) ||
               std::string_view("_-./:,+=@%").find(char(letter)) != std::string_view::npos;
    };
    if (!word.empty() && std::ranges::all_of(word, plain)) return word;
    std::string text = "'";
    for (const char letter : word)
        text += letter == '\'' ? std::string("'\\''") : std::string{letter};
    return text + "'";
}

std::vector<NextStep> next_steps(const FileContents& contents) {
    const std::string file = quoted(contents.file);
    const std::string png = beside(contents.file, ".png");
    if (contents.kind == FileKind::volume) return steps_of_volume(contents);
    if (contents.kind == FileKind::points) return steps_of_points(contents);
    if (is_site(contents.file))
        return {{fmt::format("vog serve {}", file), "the page, in a browser"},
                {fmt::format("vog render {} -o {}", file, png), "a picture"},
                {fmt::format("vog view {}", file), "a window"}};
    return steps_of_model(contents);
}

namespace {

/// A kind of data that Python reads for vog (python/vog/_load.py): what it is, and the extensions of its files; folders and others are
/// told apart by their contents.
struct PythonReader {
    const char* what;
    std::vector<std::string> extensions;
};
const PythonReader kYt{"a data set of a simulation", {".athdf"}};
const PythonReader kZarr{"a store of Zarr", {".zarr"}};
const PythonReader kPythonReaders[] = {
    {"NumPy arrays", {".npy", ".npz"}},
    {"NetCDF or GRIB", {".nc", ".nc4", ".cdf", ".grib", ".grb", ".grib2", ".grb2"}},
    {"data of VTK",
     {".vti", ".vtk", ".vtu", ".vtr", ".vts", ".vtm", ".vtmb", ".pvti", ".pvtu", ".pvtr", ".pvts",
      ".pvd", ".exo", ".ex2", ".e", ".case", ".foam", ".cgns"}},
    {"a slice of DICOM", {".dcm", ".ima"}},
    {"openPMD", {".bp", ".bp4", ".bp5"}},
    kZarr,
    kYt,
};

std::string python_advice(const PythonReader& reader, const std::string& file) {
    return fmt::format(
        "{}, which Python reads for vog: python3 -m vog render {} -o {}; every other command works "
        "the same way; in Python vog.load (docs/python.md)",
        reader.what, quoted(file), beside(file, ".png"));
}

/// Advice on data of simulations and on Zarr, which are told by their files.
std::string advice_on_contents(const std::string& file) {
    const fs::path path(file);
    std::error_code code;
    const auto has = [&](const char* name) { return fs::exists(path / name, code); };
    if (has("zarr.json") || has(".zgroup") || has(".zarray") || has(".zmetadata"))
        return python_advice(kZarr, file);
    if (has("Header") && has("Level_0")) return python_advice(kYt, file);        // AMReX, Boxlib
    if (fs::exists(file + ".hierarchy", code)) return python_advice(kYt, file);  // Enzo
    if (!fs::is_directory(path, code)) return {};
    for (const fs::directory_entry& entry : fs::directory_iterator(path, code)) {
        const fs::path inside = entry.path();
        const bool ramses =
            inside.extension() == ".txt" && inside.filename().string().starts_with("info_");
        if (ramses || inside.extension() == ".hierarchy") return python_advice(kYt, file);
    }
    return {};
}

/// Whether one of the first lines of a text begins with three numbers, as those of particles do.
bool has_lines_of_numbers(const std::string& file) {
    constexpr std::size_t kHead = 4096;
    std::error_code code;
    if (!fs::is_regular_file(file, code)) return false;
    std::string head(kHead, ' ');
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), kHead);
    head.resize(static_cast<std::size_t>(in.gcount()));
    if (head.find('\0') != head.npos) return false;
    std::ranges::replace_if(
        head, [](char c) { return c == ',' || c == ';'; }, ' ');
    std::istringstream lines(head);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream fields(line);
        double x, y, z;
        if (fields >> x >> y >> z) return true;
    }
    return false;
}

}  // namespace

std::string advice_on_hdf5(const std::string& file) {
    return "or " + python_advice({"arrays in HDF5", {}}, file);
}

std::string advice_on_text(const std::string& file) {
    if (!has_lines_of_numbers(file)) return {};
    return fmt::format(
        "unknown extension '{}' of a text with numbers; call it {} to read particles",
        extension_of(file), quoted(file + ".txt"));
}

std::string advice_on(const std::string& file) {
    const std::string extension = extension_of(file);
    const std::string name = quoted(file);
    if (std::string advice = advice_on_contents(file); !advice.empty()) return advice;
    for (const PythonReader& reader : kPythonReaders)
        if (std::ranges::find(reader.extensions, extension) != reader.extensions.end())
            return python_advice(reader, file);
    if (extension == ".html") return "a page: open it in a browser";
    if (extension == ".png" || extension == ".jpg" || extension == ".jpeg")
        return fmt::format("a picture; vog compare REFERENCE.png {} measures its error", name);
    if (extension == ".exr")
        return fmt::format(
            "an image of optical depth or values; vog compare REFERENCE.exr {} measures its error",
            name);
    if (extension == ".obj" || extension == ".stl")
        return fmt::format(
            "a mesh of triangles, not a volume: vog render VOLUME --show volume --layer {} draws "
            "it in one; vdb_tool or Blender's Mesh to Volume makes it a .vdb",
            name);
    if (extension == ".usdz")
        return "a package of OpenUSD: unzip it; vog reads the splats of a .usda, which usdcat "
               "makes of a .usdc";
    if (extension == ".mp4" || extension == ".webm") return "a film: open it in a player";
    if (extension == ".json") {
        const nlohmann::json json = json_of(file);
        if (!json.is_object() && !json.is_array()) return {};
        const nlohmann::json& first = json.is_array() && !json.empty() ? json.front() : json;
        if (!first.is_object()) return {};
        if (first.contains("eye") && first.contains("look_at"))
            return fmt::format("a camera; vog render FILE -o picture.png --camera {}", name);
        if (first.contains("RGBPoints") || first.contains("colors"))
            return fmt::format("a transfer function; vog render FILE -o picture.png --tf {}", name);
    }
    return {};
}

}  // namespace vog::cli
