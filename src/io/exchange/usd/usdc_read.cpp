// usdc_read.cpp: prims of an OpenUSD crate; of the values those of splats alone are read.
// Source: crate_codes.h.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

#include "io/exchange/usd/crate_codes.h"
#include "io/exchange/usd/usd_prims.h"
#include "vog/error.h"

namespace vog::exchange::usd {

namespace {

float float_of_half(std::uint16_t half) {
    const int exponent = half >> 10 & 31, digits = half & 1023;
    const float size = exponent == 31 ? (digits ? std::nanf("") : HUGE_VALF)
                       : exponent == 0
                           ? std::ldexp(static_cast<float>(digits), -24)
                           : std::ldexp(static_cast<float>(1024 + digits), exponent - 25);
    return half & 0x8000 ? -size : size;
}
float as_float(std::uint16_t half) { return float_of_half(half); }
float as_float(float value) { return value; }
float as_float(double value) {
    return std::abs(value) > std::numeric_limits<float>::max()
               ? std::copysign(HUGE_VALF, value > 0 ? 1.0f : -1.0f)
               : static_cast<float>(value);
}

struct Field {
    std::string_view name;
    CrateValue value;
};
struct Spec {
    std::size_t path = 0, fields = 0;
    std::uint32_t kind = 0;
};
/// An element of the tree of paths.
struct Path {
    std::ptrdiff_t parent = -1;
    std::string_view name;
    int above = -1;  ///< paths above, -1 before the path is placed
};

class Crate {
  public:
    Crate(FileBytes& in, const std::string& file) : in_(in), file_(file) {
        read_contents();
        read_tokens();
        read_fields();
        read_paths();
        read_specs();
    }

    std::vector<Prim> prims() {
        std::vector<Prim> out;
        std::vector<std::ptrdiff_t> prim_of(paths_.size(), -1);
        for (const Spec& spec : specs_) {
            if (spec.kind != prim_spec) continue;
            prim_of[spec.path] = static_cast<std::ptrdiff_t>(out.size());
            out.push_back(prim_from(spec));
        }
        for (const Spec& spec : specs_)
            if (spec.kind == prim_spec) {
                const std::ptrdiff_t above = paths_[spec.path].parent;
                if (above >= 0)
                    out[static_cast<std::size_t>(prim_of[spec.path])].parent =
                        prim_of[static_cast<std::size_t>(above)];
            }
        for (const Spec& spec : specs_) {
            const std::ptrdiff_t above = paths_[spec.path].parent;
            if (spec.kind != attribute_spec || above < 0) continue;
            const std::ptrdiff_t own = prim_of[static_cast<std::size_t>(above)];
            if (own >= 0) read_attribute(spec, out[static_cast<std::size_t>(own)]);
        }
        return out;
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}", file_, what));
    }
    [[noreturn]] void corrupt(const std::string& what) const { fail("corrupt: " + what); }

    void read_contents() {
        in_.take(std::char_traits<char>::length(kCrateMark));
        const std::string version(in_.take(8), 8);
        constexpr int kFirst = 7, kLast = 13;  // 64-bit sizes of arrays; arrays of edits
        if (version[0] != 0 || version[1] < kFirst || version[1] > kLast)
            fail(fmt::format("a crate of version {}.{}.{}, expected 0.{} to 0.{}", int{version[0]},
                             int{version[1]}, int{version[2]}, kFirst, kLast));
        in_.seek(kTableAt);
        const auto table = in_.number<std::uint64_t>();
        if (table > in_.size()) corrupt("truncated, no table of contents");
        in_.seek(table);
        const auto count = in_.number<std::uint64_t>();
        constexpr std::uint64_t kMostSections = 64;
        if (count > kMostSections) corrupt(fmt::format("{} sections", count));
        for (std::uint64_t n = 0; n < count; ++n) {
            const auto section = in_.number<CrateSection>();
            if (section.start > in_.size() || section.size > in_.size() - section.start)
                corrupt("a section beyond the end: truncated");
            sections_[std::string(section.name, strnlen(section.name, sizeof section.name))] =
                section;
        }
    }
    BigVector<char> section(const char* name) {
        const auto found = sections_.find(name);
        if (found == sections_.end()) corrupt(fmt::format("no section {}", name));
        return in_.range(found->second.start, found->second.start + found->second.size);
    }
    /// Number of elements; each takes a byte or more in files of splats, which bounds memory.
    std::size_t count_of(ByteSource& bytes) {
        const auto count = bytes.number<std::uint64_t>();
        if (count > in_.size()) corrupt(fmt::format("{} elements", count));
        return count;
    }
    std::span<const char> packed(ByteSource& bytes) const {
        const auto size = bytes.number<std::uint64_t>();
        const char* begin = bytes.take(size);
        if (size == 0) corrupt("an empty block");
        return {begin, size};
    }
    std::vector<std::int32_t> numbers(ByteSource& bytes, std::size_t count) const try {
        return crate_decoded(packed(bytes), count);
    } catch (const CrateFault& fault) {
        fail(fault.what());
    }
    std::string unpacked(ByteSource& bytes, std::size_t size) const try {
        return crate_unpacked(packed(bytes), size);
    } catch (const CrateFault& fault) {
        fail(fault.what());
    }
    std::string_view token(std::int64_t index) const {
        if (index < 0 || index >= static_cast<std::int64_t>(tokens_.size()))
            corrupt(fmt::format("token {} of {}", index, tokens_.size()));
        return tokens_[static_cast<std::size_t>(index)];
    }

    void read_tokens() {
        const BigVector<char> all = section("TOKENS");
        MemoryBytes bytes({all.data(), all.size()}, file_, 0);
        const std::size_t count = count_of(bytes);
        const auto size = bytes.number<std::uint64_t>();
        const std::string text = unpacked(bytes, size);
        for (std::size_t at = 0; at < text.size() && tokens_.size() < count;) {
            tokens_.emplace_back(text.c_str() + at);
            at += tokens_.back().size() + 1;
        }
        if (text.size() != size || tokens_.size() != count)
            corrupt(fmt::format("{} tokens, expected {}", tokens_.size(), count));
    }
    void read_fields() {
        const BigVector<char> all = section("FIELDS");
        MemoryBytes bytes({all.data(), all.size()}, file_, 0);
        const std::size_t count = count_of(bytes);
        const std::vector<std::int32_t> names = numbers(bytes, count);
        const std::string values = unpacked(bytes, count * sizeof(CrateValue));
        if (values.size() != count * sizeof(CrateValue))
            corrupt(fmt::format("{} bytes of {} values", values.size(), count));
        for (std::size_t n = 0; n < count; ++n) {
            fields_.push_back({token(names[n]), {}});
            std::memcpy(&fields_.back().value, values.data() + n * sizeof(CrateValue),
                        sizeof(CrateValue));
        }
        const BigVector<char> sets = section("FIELDSETS");
        MemoryBytes set_bytes({sets.data(), sets.size()}, file_, 0);
        const std::size_t size = count_of(set_bytes);
        sets_ = numbers(set_bytes, size);
    }
    void read_paths() {
        const BigVector<char> all = section("PATHS");
        MemoryBytes bytes({all.data(), all.size()}, file_, 0);
        paths_.resize(count_of(bytes));
        const std::size_t count = count_of(bytes);
        const std::vector<std::int32_t> index = numbers(bytes, count),
                                        names = numbers(bytes, count),
                                        jumps = numbers(bytes, count);
        // Depth first: -2 ends, -1 goes on with a child, 0 with a sibling, others with a child, and the sibling that far on.
        std::vector<std::pair<std::size_t, std::ptrdiff_t>> left;
        if (count > 0) left.emplace_back(0, -1);
        while (!left.empty()) {
            auto [at, parent] = left.back();
            left.pop_back();
            for (bool more = true; more; ++at) {
                if (at >= count || index[at] < 0 || std::size_t(index[at]) >= paths_.size())
                    corrupt("a path that is not there");
                Path& path = paths_[static_cast<std::size_t>(index[at])];
                if (path.above >= 0) corrupt("a path in two places");
                constexpr int kMostAbove = 256;
                const int above =
                    parent < 0 ? 0 : 1 + paths_[static_cast<std::size_t>(parent)].above;
                if (above > kMostAbove) corrupt(fmt::format("a path below {} others", kMostAbove));
                path = {parent, parent < 0 ? "" : token(std::abs(std::int64_t{names[at]})), above};
                const std::int64_t jump = jumps[at];
                if (jump > 0) left.emplace_back(at + static_cast<std::size_t>(jump), parent);
                if (jump > 0 || jump == -1) parent = index[at];
                more = jump >= -1;
            }
        }
    }
    void read_specs() {
        const BigVector<char> all = section("SPECS");
        MemoryBytes bytes({all.data(), all.size()}, file_, 0);
        const std::size_t count = count_of(bytes);
        const std::vector<std::int32_t> path = numbers(bytes, count), set = numbers(bytes, count),
                                        kind = numbers(bytes, count);
        for (std::size_t n = 0; n < count; ++n) {
            if (path[n] < 0 || std::size_t(path[n]) >= paths_.size() || set[n] < 0 ||
                std::size_t(set[n]) >= sets_.size())
                corrupt("a spec without a path or fields");
            specs_.push_back({static_cast<std::size_t>(path[n]), static_cast<std::size_t>(set[n]),
                              static_cast<std::uint32_t>(kind[n])});
        }
    }

    /// Calls each(field) for the fields of a spec.
    template <class Each>
    void each_field(const Spec& spec, const Each& each) const {
        constexpr std::size_t kMostFields = 256;
        for (std::size_t n = 0;; ++n) {
            if (spec.fields + n >= sets_.size() || n == kMostFields)
                corrupt("a set of fields without an end");
            const std::int32_t index = sets_[spec.fields + n];
            if (index == -1) return;
            if (index < 0 || std::size_t(index) >= fields_.size()) corrupt("a field not there");
            each(fields_[static_cast<std::size_t>(index)]);
        }
    }
    Prim prim_from(const Spec& spec) const {
        Prim prim;
        constexpr std::size_t kLongest = 100;  // in messages alone; paths share their names
        prim.name = paths_[spec.path].name.substr(0, kLongest);
        bool defined = false, active = true;
        each_field(spec, [&](const Field& field) {
            const CrateType type = field.value.type();
            const std::uint64_t payload = field.value.payload();
            if (field.name == "specifier" && type == CrateType::specifier) defined = payload == 0;
            if (field.name == "active" && type == CrateType::boolean) active = payload != 0;
            if (field.name == "typeName" && type == CrateType::token)
                prim.splats = token(static_cast<std::int64_t>(payload)) == kSplatType;
        });
        prim.absent = !defined || !active;
        return prim;
    }
    void read_attribute(const Spec& spec, Prim& prim) {
        const std::string_view name = paths_[spec.path].name;
        const auto attribute = attribute_named(name);
        if (name != "xformOpOrder" && name != kFrameAttribute && !(prim.splats && attribute))
            return;
        each_field(spec, [&](const Field& field) {
            if (name == kFrameAttribute) {
                if (field.name == "default" && field.value.type() == CrateType::token)
                    prim.frame = token(static_cast<std::int64_t>(field.value.payload()));
            } else if (!attribute)
                prim.moved |= field.name == "default" && field.value.payload() != 0;
            else if (field.name == "timeSamples")
                prim.sampled = kAttributes[attribute->index];
            else if (field.name == "default")
                set_numbers(prim, *attribute, array(field.value, name, attribute->index));
        });
    }

    /// Numbers of an array, orientations as w x y z.
    std::vector<float> array(CrateValue value, std::string_view name, std::size_t index) {
        using enum CrateType;
        const std::size_t width = kComponents[index];
        const CrateType type = value.type();
        const bool doubles = type == float64 || type == vec3_64 || type == quat64,
                   halves = type == float16 || type == vec3_16 || type == quat16;
        const CrateType expected = width == 1   ? doubles  ? float64
                                                  : halves ? float16
                                                           : float32
                                   : width == 3 ? doubles  ? vec3_64
                                                  : halves ? vec3_16
                                                           : vec3_32
                                   : doubles    ? quat64
                                   : halves     ? quat16
                                                : quat32;
        if (!value.array() || value.inlined() || type != expected)
            fail(fmt::format("{} of type {}, expected an array of {} floats each", name,
                             static_cast<int>(type), width));
        if (value.payload() == 0) return {};
        in_.seek(value.payload());
        std::vector<float> out = doubles  ? values<double>(value, width)
                                 : halves ? values<std::uint16_t>(value, width)
                                          : values<float>(value, width);
        if (width == 4)  // imaginary parts come first in the file
            for (std::size_t n = 0; n < out.size(); n += 4)
                std::rotate(&out[n], &out[n] + 3, &out[n] + 4);
        return out;
    }
    template <class T>
    std::vector<float> values(CrateValue value, std::size_t width) {
        const std::size_t rows = count_of(in_);
        constexpr std::size_t kLeastCompressed = 16;
        if (value.compressed() && rows >= kLeastCompressed) return compressed_values<T>(rows);
        const std::size_t count = rows * width;
        claim(count * sizeof(T));
        const char* bytes = in_.take(count * sizeof(T));
        std::vector<float> out(count);
        for (std::size_t n = 0; n < count; ++n) {
            T number{};
            std::memcpy(&number, bytes + n * sizeof number, sizeof number);
            out[n] = as_float(number);
        }
        return out;
    }
    /// Whole numbers, or places in a table of the values that there are.
    template <class T>
    std::vector<float> compressed_values(std::size_t count) {
        const auto code = in_.number<char>();
        std::vector<float> table;
        if (code == 't') {
            const auto size = in_.number<std::uint32_t>();
            const char* bytes = in_.take(std::uint64_t{size} * sizeof(T));
            for (std::size_t n = 0; n < size; ++n) {
                T number{};
                std::memcpy(&number, bytes + n * sizeof number, sizeof number);
                table.push_back(as_float(number));
            }
        } else if (code != 'i') {
            corrupt(fmt::format("numbers compressed by method {}", int{code}));
        }
        claim(count);
        std::vector<float> out;
        for (const std::int32_t number : numbers(in_, count)) {
            if (code == 't' && static_cast<std::uint32_t>(number) >= table.size())
                corrupt("a number beyond its table");
            out.push_back(code == 't' ? table[static_cast<std::uint32_t>(number)]
                                      : static_cast<float>(number));
        }
        return out;
    }
    /// Arrays that share bytes would take memory without end.
    void claim(std::size_t bytes) {
        claimed_ += bytes;
        constexpr std::size_t kShares = 4;
        if (claimed_ > kShares * in_.size())
            corrupt(fmt::format("{} bytes of splats in {} bytes", claimed_, in_.size()));
    }

    FileBytes& in_;
    std::string file_;
    std::map<std::string, CrateSection> sections_;
    std::vector<std::string> tokens_;
    std::vector<Field> fields_;
    std::vector<std::int32_t> sets_;
    std::vector<Path> paths_;
    std::vector<Spec> specs_;
    std::size_t claimed_ = 0;
};

}  // namespace

std::vector<Prim> read_crate(FileBytes& in, const std::string& file) {
    return Crate(in, file).prims();
}

}  // namespace vog::exchange::usd
