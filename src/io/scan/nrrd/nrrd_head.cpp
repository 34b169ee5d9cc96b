// nrrd_head.cpp: fields of the head of NRRD files.
#include "io/scan/nrrd/nrrd_head.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "io/scan/text_head.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

/// Fields with one meaning under several names.
std::string canonical(const std::string& key) {
    static const std::map<std::string, std::string> kOther{
        {"datafile", "data file"},    {"lineskip", "line skip"},
        {"byteskip", "byte skip"},    {"sampleunits", "sample units"},
        {"axismins", "axis mins"},    {"axismaxs", "axis maxs"},
        {"centerings", "centers"},    {"blocksize", "block size"},
        {"spaceunits", "space units"}};
    const auto at = kOther.find(key);
    return at == kOther.end() ? key : at->second;
}

}  // namespace

void NrrdHead::fail(const std::string& what) const {
    throw Error(fmt::format("{}: {}", file.string(), what));
}

NrrdHead read_nrrd_head(const std::filesystem::path& file) {
    NrrdHead head;
    head.file = file;
    TextHead text(file);
    std::string line;
    if (!text.next(line) || !line.starts_with("NRRD000"))
        head.fail("no first line 'NRRD000x', expected an NRRD file");
    if (line.size() != 8 || line[7] < '1' || line[7] > '5')
        head.fail(fmt::format("version '{}', expected NRRD0001 to NRRD0005", printable(line, 20)));
    while (true) {
        // The head of a detached file may end with the file.
        if (!text.next(line)) {
            if (!head.fields.contains("data file"))
                head.fail("truncated: a head without the empty line at its end");
            break;
        }
        if (line.empty()) break;
        if (line.front() == '#') continue;
        const std::size_t colon = line.find(": ");
        const std::size_t pair = line.find(":=");
        if (pair < colon) continue;  // keys and values of users
        if (colon == std::string::npos)
            head.fail(fmt::format("line '{}', expected 'field: value'", printable(line, 40)));
        const std::string key = canonical(lower_case(line.substr(0, colon)));
        if (key == "data file" && without_blanks(line.substr(colon + 2)).empty())
            head.fail("data file names no file");
        if (!head.fields.emplace(key, without_blanks(line.substr(colon + 2))).second)
            head.fail(fmt::format("field '{}' twice", printable(key, 40)));
        if (key == "data file" && words_of(head.text(key)).front() == "LIST")
            while (text.next(line))
                if (const std::string name(without_blanks(line)); !name.empty())
                    head.list.push_back(name);
    }
    head.bytes = text.position();
    return head;
}

NrrdVectors vectors_of(const NrrdHead& head, const std::string& key) {
    NrrdVectors vectors;
    std::string_view text = head.fields.at(key);
    const auto fail = [&] {
        head.fail(fmt::format("{} '{}', expected vectors (x,y,z) or none", key,
                              printable(head.text(key), 60)));
    };
    while (!(text = without_blanks(text)).empty()) {
        if (text.starts_with("none")) {
            vectors.emplace_back();
            text.remove_prefix(4);
            continue;
        }
        const std::size_t end = text.find(')');
        if (text.front() != '(' || end == std::string_view::npos) fail();
        std::string inside(text.substr(1, end - 1));
        for (char& c : inside)
            if (c == ',') c = ' ';
        const std::vector<double> v = numbers_of(head.file, key, inside);
        if (v.size() < 2 || v.size() > 4) fail();
        vectors.emplace_back();
        if (!std::ranges::all_of(v, [](double x) { return std::isnan(x); })) vectors.back() = v;
        text.remove_prefix(end + 1);
    }
    return vectors;
}

}  // namespace vog::scan
