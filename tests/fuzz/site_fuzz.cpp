// site_fuzz.cpp: Sites: manifests of any bytes, rows and tables of any JSON, chunks of any bytes under their right names, and models
// of any numbers on their way through a folder.
#include <cmath>
#include <filesystem>
#include <fstream>

#include "drawn.h"
#include "fuzz_target.h"
#include "io/site/chunk_file.h"
#include "io/site/chunk_name.h"
#include "io/site/manifest.h"
#include "vog/site.h"

namespace vog::fuzz {

// Equal Gaussians take no bytes each.
const Limits kLimits{.memory_ratio = 4096};

namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, std::string_view bytes) {
    fs::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
}

/// A folder without files.
fs::path empty_folder() {
    const fs::path folder = scratch_file("site");
    fs::remove_all(folder);
    return folder;
}

/// A manifest as it is.
void read_whole_manifest(std::string_view input) {
    const fs::path folder = empty_folder();
    write(folder / site::kManifestName, input);
    SiteInfo info;
    if (!accepted([&] { info = read_site_info(folder); })) return;
    expect(!info.models.empty(), "a manifest has a model");
    accepted([&] { (void)read_site(folder); });
}

/// A table of rows under its right name and size.
void read_table(std::string_view input) {
    const fs::path folder = empty_folder();
    const std::string text(input);
    site::Row row;
    row.nodes = row.gaussians = 1;
    row.table = site::content_name(std::span(&text, 1));
    row.table_bytes = static_cast<std::uint32_t>(text.size());
    write(site::table_path(folder, row.table), text);
    std::vector<site::Row> parts;
    if (!accepted([&] { parts = site::read_parts(folder, row, 1); })) return;
    for (const site::Row& part : parts) {
        expect(site::is_content_name(part.name), "names are of content");
        expect(part.gaussians > 0 && part.nodes <= part.gaussians, "counts are of a chunk");
        expect(std::isfinite(part.error) && part.error >= 0, "errors are finite");
    }
}

/// A chunk of any bytes: shapes, and a scalar field.
void read_any_chunk(std::string_view input) {
    const fs::path folder = empty_folder();
    if (input.size() < 3) return;
    const auto byte = [&](std::size_t n) { return static_cast<unsigned char>(input[n]); };
    const std::string_view rest = input.substr(3);
    const std::size_t shapes = std::min<std::size_t>(byte(0) + 256u * byte(1), rest.size());
    const std::vector<std::string> contents{std::string(rest.substr(0, shapes)),
                                            std::string(rest.substr(shapes))};
    site::ManifestModel model;
    model.rotated = byte(2) % 2;
    model.description.fields.scalar.resize(1);
    model.description.fields.scalar.front().name = "density";
    site::Row row;
    row.name = site::content_name(contents);
    row.gaussians = byte(2) / 2 + 1;
    for (const std::string& content : contents)
        row.bytes.push_back(static_cast<std::uint32_t>(content.size()));
    write(site::shapes_path(folder, row.name), contents[0]);
    write(site::field_path(folder, row.name, 0), contents[1]);
    Gaussians chunk;
    if (!accepted([&] { chunk = site::read_chunk(folder, row, model); })) return;
    expect(chunk.size() == row.gaussians, "a chunk has the number of its row");
}

/// Models of any numbers.
void write_and_read(Bytes input) {
    Numbers numbers(input);
    Gaussians model = drawn_model(numbers);
    model.fields = drawn_fields(numbers, model.size());
    if (model.size() < 2 || !accepted([&] { validate(model); })) return;
    const fs::path folder = empty_folder();
    Hierarchy hierarchy;
    if (!accepted([&] { hierarchy = build_hierarchy(model); })) return;
    const auto written = [&] {
        SiteWriter writer(folder);
        writer.add("drawn", model, hierarchy);
        writer.finish();
    };
    if (!accepted(written)) return;
    Gaussians read;
    expect(accepted([&] { read = read_site(folder); }), "a model that is written is read");
    expect(read.size() == model.size(), "all Gaussians are kept");
    expect(read.fields.names() == model.fields.names(), "all fields are kept");
}

}  // namespace

void run(Bytes input) {
    if (input.empty()) return;
    const Bytes rest = input.subspan(1);
    const std::string_view text(reinterpret_cast<const char*>(rest.data()), rest.size());
    switch (input.front() % 4) {
        case 0:
            return read_whole_manifest(text);
        case 1:
            return read_table(text);
        case 2:
            return read_any_chunk(text);
        default:
            return write_and_read(rest);
    }
}

}  // namespace vog::fuzz
