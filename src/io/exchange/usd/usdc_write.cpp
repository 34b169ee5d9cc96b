// usdc_write.cpp: OpenUSD as a binary crate of version 0.8, the prim of usda_write.cpp.
// Source: crate_codes.h. Arrays come first, as they are; then the sections, and the table of contents.
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "io/exchange/splat_files.h"
#include "io/exchange/usd/crate_codes.h"
#include "io/exchange/usd/usd_prims.h"

namespace vog::exchange {

namespace {

using namespace usd;

class CrateWriter {
  public:
    explicit CrateWriter(std::ofstream& out) : out_(out) {
        put(std::array<char, kCrateHead>{});
        token(";-)");  // 0 has no sign, which tells properties from prims
    }

    std::int32_t token(const std::string& text) {
        const auto index =
            static_cast<std::size_t>(std::ranges::find(tokens_, text) - tokens_.begin());
        if (index == tokens_.size()) tokens_.push_back(text);
        return static_cast<std::int32_t>(index);
    }
    CrateValue token_value(const std::string& text) {
        return crate_value(CrateType::token, CrateValue::kInlined,
                           static_cast<std::uint64_t>(token(text)));
    }
    CrateValue tokens_value(const std::vector<std::string>& texts) {
        const std::uint64_t at = aligned();
        put(std::uint64_t{texts.size()});
        for (const std::string& text : texts) put(token(text));
        return crate_value(CrateType::tokens, 0, at);
    }
    /// Rows of floats, of 1, 3 or 4.
    template <class Row>
    CrateValue array_value(CrateType type, std::span<const Row> rows) {
        const std::uint64_t at = aligned();
        put(std::uint64_t{rows.size()});
        out_.write(reinterpret_cast<const char*>(rows.data()),
                   static_cast<std::streamsize>(rows.size_bytes()));
        return crate_value(type, CrateValue::kArray, at);
    }

    /// A path, by its parent's element in the tree, in the order of the tree.
    void add(const std::string& name, CrateSpec kind,
             const std::vector<std::pair<std::string, CrateValue>>& fields) {
        const std::int32_t element = token(name);
        elements_.push_back(kind == attribute_spec ? -element : element);
        kinds_.push_back(static_cast<std::int32_t>(kind));
        sets_at_.push_back(static_cast<std::int32_t>(sets_.size()));
        for (const auto& [field, value] : fields) {
            sets_.push_back(static_cast<std::int32_t>(names_.size()));
            names_.push_back(token(field));
            values_.push_back(value);
        }
        sets_.push_back(-1);
    }

    /// Sections and table; each path but the last is followed by its only child, or among attributes by its sibling.
    void finish() {
        std::vector<std::int32_t> order, jumps;
        for (std::size_t n = 0; n < elements_.size(); ++n) {
            order.push_back(static_cast<std::int32_t>(n));
            const bool attribute = kinds_[n] == attribute_spec;
            jumps.push_back(n + 1 == elements_.size() ? -2 : attribute ? 0 : -1);
        }
        std::string texts;
        for (const std::string& text : tokens_) texts.append(text.c_str(), text.size() + 1);
        section("TOKENS", [&] {
            put(std::uint64_t{tokens_.size()});
            put(std::uint64_t{texts.size()});
            put_packed(crate_packed(texts));
        });
        section("STRINGS", [&] { put(std::uint64_t{0}); });
        section("FIELDS", [&] {
            put_counted(names_);
            put_packed(crate_packed({reinterpret_cast<const char*>(values_.data()),
                                     values_.size() * sizeof(CrateValue)}));
        });
        section("FIELDSETS", [&] { put_counted(sets_); });
        section("PATHS", [&] {
            put(std::uint64_t{order.size()});
            put_counted(order);
            put_packed(crate_coded(elements_));
            put_packed(crate_coded(jumps));
        });
        section("SPECS", [&] {
            put_counted(order);
            put_packed(crate_coded(sets_at_));
            put_packed(crate_coded(kinds_));
        });
        const std::uint64_t table = place();
        put(std::uint64_t{sections_.size()});
        for (const CrateSection& section : sections_) put(section);
        out_.seekp(0);
        out_ << kCrateMark;
        put(std::array<char, 8>{0, 8, 0});
        put(table);
    }

  private:
    template <class T>
    void put(const T& value) {
        out_.write(reinterpret_cast<const char*>(&value), sizeof value);
    }
    void put_packed(const std::string& bytes) {
        put(std::uint64_t{bytes.size()});
        out_ << bytes;
    }
    void put_counted(std::span<const std::int32_t> numbers) {
        put(std::uint64_t{numbers.size()});
        put_packed(crate_coded(numbers));
    }
    std::uint64_t place() { return static_cast<std::uint64_t>(out_.tellp()); }
    /// The next multiple of 8 bytes: arrays can be used where they lie in memory.
    std::uint64_t aligned() {
        while (place() % 8 != 0) put(char{0});
        return place();
    }
    template <class Write>
    void section(const char* name, const Write& write) {
        CrateSection section{};
        std::strncpy(section.name, name, sizeof section.name - 1);
        section.start = place();
        write();
        section.size = place() - section.start;
        sections_.push_back(section);
    }

    std::ofstream& out_;
    std::vector<std::string> tokens_;
    std::vector<std::int32_t> elements_, kinds_, sets_at_, sets_, names_;
    std::vector<CrateValue> values_;
    std::vector<CrateSection> sections_;
};

template <class T>
std::span<const T> all(const std::vector<T>& values) {
    return values;
}

}  // namespace

void write_usdc(std::ofstream& out, const Splats& splats, const std::string& frame) {
    using enum CrateType;
    struct Attribute {
        std::string name, type;
        CrateValue value;
    };
    CrateWriter crate(out);
    const Box box = splat_extent(splats);
    const std::vector<Vec3f> extent{vec_cast<float>(box.lower), vec_cast<float>(box.upper)};
    std::vector<std::array<float, 4>> turns;  // the file's order
    for (const Quat q : splats.rotation) turns.push_back({q.x, q.y, q.z, q.w});
    std::vector<Vec3f> dc;
    for (const Vec3f color : splats.color) dc.push_back(harmonics(color));
    const std::string degree = "radiance:sphericalHarmonicsDegree";
    const std::vector<Attribute> attributes{
        {"extent", "float3[]", crate.array_value(vec3_32, all(extent))},
        {"positions", "point3f[]", crate.array_value(vec3_32, all(splats.mean))},
        {"orientations", "quatf[]", crate.array_value(quat32, all(turns))},
        {"scales", "float3[]", crate.array_value(vec3_32, all(splats.scale))},
        {"opacities", "float[]", crate.array_value(float32, all(splats.opacity))},
        {degree, "int", crate_value(int32, CrateValue::kInlined, 0)},
        {"radiance:sphericalHarmonicsCoefficients", "float3[]",
         crate.array_value(vec3_32, all(dc))},
        {kFrameAttribute, "token", crate.token_value(frame)}};
    std::vector<std::string> names;
    for (const Attribute& attribute : attributes) names.push_back(attribute.name);

    // Doubles that are floats, and words of 32 bits, lie in the value itself.
    const auto inlined = [](CrateType type, std::uint32_t payload) {
        return crate_value(type, CrateValue::kInlined, payload);
    };
    crate.add("", root_spec,
              {{"defaultPrim", crate.token_value("Splats")},
               {"metersPerUnit", inlined(float64, std::bit_cast<std::uint32_t>(1.0f))},
               {"upAxis", crate.token_value("Y")},
               {"primChildren", crate.tokens_value({"Splats"})}});
    crate.add("Splats", prim_spec,
              {{"specifier", inlined(specifier, 0)},
               {"typeName", crate.token_value(kSplatType)},
               {"properties", crate.tokens_value(names)}});
    for (const Attribute& attribute : attributes) {
        std::vector<std::pair<std::string, CrateValue>> fields{
            {"typeName", crate.token_value(attribute.type)}, {"default", attribute.value}};
        const bool own = attribute.name == kFrameAttribute;
        if (own) fields.emplace_back("custom", inlined(boolean, 1));
        if (own || attribute.name == degree)
            fields.emplace_back("variability", inlined(variability, 1));
        crate.add(attribute.name, attribute_spec, fields);
    }
    crate.finish();
}

}  // namespace vog::exchange
