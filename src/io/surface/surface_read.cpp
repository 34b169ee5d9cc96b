// surface_read.cpp: triangles of STL, PLY and OBJ.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <unordered_map>
#include <utility>

#include "vog/error.h"
#include "vog/surface.h"

namespace vog {

namespace {

using Color = std::array<float, 3>;

std::string extension_of(const std::filesystem::path& file) {
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

[[noreturn]] void fail(const std::string& what) { throw Error(what); }

/// Points and polygons of a file as triangles, whose points at one place are one.
struct Polygons {
    std::vector<Vec3d> point;
    std::vector<Color> color;  ///< [point] or none
    Surface surface{};
    std::size_t left_out = 0;

    /// Corners by their places in the file, any number of them: ears are cut off until a triangle is left.
    /// first  number of the file's first point
    void add(const std::vector<double>& corners, int first = 0) {
        std::vector<std::size_t> ring;
        for (const double c : corners) {
            if (!(c >= 0 && c < static_cast<double>(point.size())))
                fail(fmt::format("a face of point {}, expected {} to {}", c + first, first,
                                 static_cast<double>(point.size()) + first - 1));
            ring.push_back(static_cast<std::size_t>(c));
        }
        Vec3d normal{};
        for (std::size_t n = 2; n < ring.size(); ++n)
            normal = normal +
                     cross(point[ring[n - 1]] - point[ring[0]], point[ring[n]] - point[ring[0]]);
        while (ring.size() > 3) {
            std::size_t ear = 0;
            while (ear < ring.size() && !is_ear(ring, ear, normal)) ++ear;
            if (ear == ring.size()) ear = 0;  // without an area, or with edges that cross
            add_triangle(ring[(ear + ring.size() - 1) % ring.size()], ring[ear],
                         ring[(ear + 1) % ring.size()]);
            ring.erase(ring.begin() + static_cast<std::ptrdiff_t>(ear));
        }
        if (ring.size() == 3) add_triangle(ring[0], ring[1], ring[2]);
    }

  private:
    void add_triangle(std::size_t a, std::size_t b, std::size_t c) {
        const double area = length(cross(point[b] - point[a], point[c] - point[a]));
        if (std::isfinite(area) && area > 0)
            surface.triangle.push_back({place(a), place(b), place(c)});
        else
            ++left_out;
    }
    /// Whether a corner points outwards, and the triangle that it makes with its neighbours holds no other corner.
    bool is_ear(const std::vector<std::size_t>& ring, std::size_t n, const Vec3d& normal) const {
        const std::size_t count = ring.size();
        const Vec3d corner[3] = {point[ring[(n + count - 1) % count]], point[ring[n]],
                                 point[ring[(n + 1) % count]]};
        const auto is_left = [&](const Vec3d& a, const Vec3d& b, const Vec3d& at) {
            return dot(cross(b - a, at - a), normal) > 0;
        };
        if (!is_left(corner[0], corner[1], corner[2])) return false;
        for (std::size_t k = 2; k + 1 < count; ++k) {
            const Vec3d at = point[ring[(n + k) % count]];
            if (is_left(corner[0], corner[1], at) && is_left(corner[1], corner[2], at) &&
                is_left(corner[2], corner[0], at))
                return false;
        }
        return true;
    }
    struct Hash {
        std::size_t operator()(const Vec3d& p) const {
            const std::hash<double> hash;
            return hash(p.x) ^ (hash(p.y) * 0x9e3779b97f4a7c15) ^ (hash(p.z) * 0xc2b2ae3d27d4eb4f);
        }
    };
    std::uint32_t place(std::size_t n) {
        const auto [found, is_new] =
            places_.try_emplace(point[n], static_cast<std::uint32_t>(surface.point.size()));
        if (!is_new) return found->second;
        surface.point.push_back(point[n]);
        if (!color.empty()) surface.color.push_back(color[n]);
        return found->second;
    }
    std::unordered_map<Vec3d, std::uint32_t, Hash> places_;
};

Color clamped(const double* of, double most) {
    const auto part = [&](double c) {
        return static_cast<float>(c > 0 ? std::min(c / most, 1.0) : 0);
    };
    return {part(of[0]), part(of[1]), part(of[2])};
}

void read_stl(const std::string& bytes, Polygons& to) {
    std::uint32_t count = 0;
    std::string start = bytes.substr(0, 5);
    std::ranges::transform(start, start.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (bytes.size() >= 84) std::memcpy(&count, bytes.data() + 80, 4);
    // Some programs fill up the end of the file.
    if (count > 0 && bytes.size() >= 84 + std::size_t{50} * count) {
        for (std::size_t n = 0; n < count; ++n) {
            float corner[9];
            std::memcpy(corner, bytes.data() + 84 + 50 * n + 12, sizeof corner);
            for (int c = 0; c < 9; c += 3)
                to.point.push_back(
                    {double{corner[c]}, double{corner[c + 1]}, double{corner[c + 2]}});
        }
    } else if (start == "solid") {
        std::istringstream in(bytes);
        for (std::string word; in >> word;) {
            std::string x, y, z;
            if ((word == "vertex" || word == "VERTEX") && in >> x >> y >> z)
                to.point.push_back({std::strtod(x.c_str(), nullptr),
                                    std::strtod(y.c_str(), nullptr),
                                    std::strtod(z.c_str(), nullptr)});
        }
    } else {
        fail(fmt::format("no text of STL, and no binary file of {} triangles: {} bytes", count,
                         bytes.size()));
    }
    for (std::size_t n = 0; n + 2 < to.point.size(); n += 3)
        to.add({double(n), double(n + 1), double(n + 2)});
}

void read_obj(const std::string& bytes, Polygons& to) {
    std::istringstream in(bytes);
    std::vector<std::vector<double>> faces;
    for (std::string line, next; std::getline(in, line);) {
        while (line.find_last_not_of("\r ") != line.npos &&
               line[line.find_last_not_of("\r ")] == '\\' && std::getline(in, next))
            line = line.substr(0, line.rfind('\\')) + ' ' + next;
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word != "v" && word != "f") continue;
        std::vector<double> numbers;  // of "7/2/3" the first one
        for (std::string one; words >> one;) {
            char* rest = nullptr;
            numbers.push_back(std::strtod(one.c_str(), &rest));
            if (rest == one.c_str())
                fail(fmt::format("'{}', expected a number", one.substr(0, 20)));
        }
        if (word == "f") {
            for (double& n : numbers) n = n < 0 ? static_cast<double>(to.point.size()) + n : n - 1;
            faces.push_back(std::move(numbers));
            continue;
        }
        if (numbers.size() < 3) fail(fmt::format("a point of {} numbers", numbers.size()));
        to.point.push_back({numbers[0], numbers[1], numbers[2]});
        if (numbers.size() < 6) continue;
        to.color.resize(to.point.size() - 1, {0.8f, 0.8f, 0.8f});
        to.color.push_back(clamped(&numbers[3], 1));
    }
    if (!to.color.empty()) to.color.resize(to.point.size(), {0.8f, 0.8f, 0.8f});
    for (const std::vector<double>& face : faces) to.add(face, 1);
}

/// Numbers of a PLY body, one after the other.
struct PlyBody {
    const char *at, *end;
    bool ascii = false, swapped = false;

    template <class Value>
    double binary() {
        std::array<char, sizeof(Value)> bytes;
        if (end - at < std::ptrdiff_t{sizeof(Value)}) fail("the file ends within its numbers");
        std::copy_n(at, sizeof(Value), bytes.begin());
        at += sizeof(Value);
        if (swapped) std::ranges::reverse(bytes);
        return static_cast<double>(std::bit_cast<Value>(bytes));
    }
    double number(const std::string& type) {
        if (ascii) {
            while (at < end && std::isspace(static_cast<unsigned char>(*at))) ++at;
            if (at == end) fail("the file ends within its numbers");
            char* rest = nullptr;
            const double value = std::strtod(at, &rest);
            if (rest == at) fail("expected a number");
            at = rest;
            return value;
        }
        if (type == "char" || type == "int8") return binary<std::int8_t>();
        if (type == "uchar" || type == "uint8") return binary<std::uint8_t>();
        if (type == "short" || type == "int16") return binary<std::int16_t>();
        if (type == "ushort" || type == "uint16") return binary<std::uint16_t>();
        if (type == "int" || type == "int32") return binary<std::int32_t>();
        if (type == "uint" || type == "uint32") return binary<std::uint32_t>();
        if (type == "float" || type == "float32") return binary<float>();
        if (type == "double" || type == "float64") return binary<double>();
        fail("a number of type '" + type.substr(0, 20) + "'");
    }
};

struct PlyProperty {
    std::string count, type, name;  ///< count: type of a list's length; empty: one number
};
struct PlyElement {
    std::string name;
    double rows = 0;
    std::vector<PlyProperty> properties{};
};

void read_rows(PlyBody& body, const PlyElement& element, Polygons& to) {
    const bool points = element.name == "vertex";
    for (double row = 0; row < element.rows && !element.properties.empty(); ++row) {
        double place[3] = {}, color[3] = {}, most = 0;
        for (const auto& [count, type, name] : element.properties) {
            if (!count.empty()) {
                std::vector<double> list;
                for (double left = body.number(count); left >= 1; --left)
                    list.push_back(body.number(type));
                if (element.name == "face" && name.starts_with("vertex_ind")) to.add(list);
                continue;
            }
            const double value = body.number(type);
            for (std::size_t c = 0; c < 3; ++c) {
                if (name == std::string(1, "xyz"[c])) place[c] = value;
                if (name == std::array{"red", "green", "blue"}[c])
                    color[c] = value, most = type.starts_with('u') ? 255 : 1;
            }
        }
        if (!points) continue;
        to.point.push_back({place[0], place[1], place[2]});
        if (most > 0) to.color.push_back(clamped(color, most));
    }
}

void read_ply_faces(const std::string& bytes, Polygons& to) {
    std::istringstream in(bytes);
    std::vector<PlyElement> elements;
    PlyBody body{bytes.data(), bytes.data() + bytes.size()};
    for (std::string line, word; word != "end_header";) {
        if (!std::getline(in, line)) fail("the header has no end");
        std::istringstream words(line);
        PlyProperty property;
        word.clear();
        words >> word;
        if (word == "format") {
            words >> word;
            body.ascii = word == "ascii", body.swapped = word == "binary_big_endian";
        } else if (word == "element") {
            words >> elements.emplace_back().name >> elements.back().rows;
        } else if (word == "property" && !elements.empty()) {
            words >> property.type;
            if (property.type == "list") words >> property.count >> property.type;
            words >> property.name;
            elements.back().properties.push_back(std::move(property));
        }
    }
    body.at += static_cast<std::ptrdiff_t>(std::max<std::streamoff>(in.tellg(), 0));
    for (const PlyElement& element : elements) read_rows(body, element, to);
}

}  // namespace

bool is_surface_file(const std::filesystem::path& file) {
    const std::string extension = extension_of(file);
    if (extension != ".ply") return extension == ".stl" || extension == ".obj";
    std::string head(std::size_t{1} << 16, '\0');
    std::ifstream in(file, std::ios::binary);
    in.read(head.data(), static_cast<std::streamsize>(head.size()));
    constexpr std::string_view kFaces = "element face ";
    const std::size_t faces = head.find(kFaces);  // 0 of them in clouds of points
    return faces < head.find("end_header") && head[faces + kFaces.size()] != '0';
}

Surface read_surface(const std::filesystem::path& file, std::vector<std::string>* notes) try {
    std::ifstream in(file, std::ios::binary);
    if (!in) fail("no such file");
    if (!is_surface_file(file)) fail("expected triangles, .stl, .obj or .ply with faces");
    const std::string bytes{std::istreambuf_iterator<char>(in), {}}, format = extension_of(file);
    Polygons all;
    (format == ".stl" ? read_stl : format == ".obj" ? read_obj : read_ply_faces)(bytes, all);
    // 3D Slicer and others state the axes in a comment: x to the patient's left, y to the back. Images are turned to RAS, too.
    constexpr std::size_t kHead = 4096;
    const auto states = [&](std::string_view space) {
        return std::string_view(bytes).substr(0, kHead).find(space) != std::string_view::npos;
    };
    const bool is_lps = states("SPACE=LPS");
    all.surface.is_ras = is_lps || states("SPACE=RAS");
    if (is_lps) {
        for (Vec3d& point : all.surface.point) point = {-point.x, -point.y, point.z};
        if (notes)
            notes->push_back(file.string() + ": states SPACE=LPS, turned to RAS as images are");
    }
    const std::size_t count = all.surface.triangle.size();
    if (count == 0)
        fail(fmt::format("no triangles{}", all.left_out ? " with finite points and an area" : ""));
    if (all.left_out > 0 && notes)
        notes->push_back(
            fmt::format("{}: {} of {} triangles left out: points that are not finite, or no area",
                        file.string(), all.left_out, all.left_out + count));
    return std::move(all.surface);
} catch (const Error& error) {
    throw Error(file.string() + ": " + error.what());
}

}  // namespace vog
