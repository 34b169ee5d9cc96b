// page_source.cpp: addresses from which pages load their models, and what pages state of those models.
#include "web/page_source.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <limits>
#include <string_view>

#include "vog/error.h"
#include "vog/site.h"
#include "vog/text.h"

namespace vog {

namespace {

[[noreturn]] void refuse(const HtmlSource& source, const std::string& why) {
    throw Error(fmt::format("{}: {}", printable(source.url, 200), why));
}

bool is_letter_or_digit(char letter) {
    return std::isalnum(static_cast<unsigned char>(letter)) != 0;
}

/// End of "scheme:" at the beginning of an address; 0: a relative one.
std::size_t scheme_end(std::string_view url) {
    const auto ends = [](char letter) {
        return !is_letter_or_digit(letter) && letter != '+' && letter != '-' && letter != '.';
    };
    const auto end = std::ranges::find_if(url, ends);
    return end != url.end() && *end == ':' ? static_cast<std::size_t>(end - url.begin()) + 1 : 0;
}

/// Host and port as a security policy names them.
void check_host(const HtmlSource& source, std::string_view host) {
    const std::size_t colon = std::min(host.find(':'), host.size());
    const std::string_view name = host.substr(0, colon);
    std::string_view port = host.substr(colon);
    const auto fits = [](char letter) {
        return is_letter_or_digit(letter) || letter == '-' || letter == '.';
    };
    if (name.empty() || !std::ranges::all_of(name, fits))
        refuse(source, "expected a host of letters, digits, dots and hyphens");
    if (port.empty()) return;
    port.remove_prefix(1);
    const auto digit = [](char letter) { return letter >= '0' && letter <= '9'; };
    if (port.empty() || port.size() > 5 || !std::ranges::all_of(port, digit))
        refuse(source, "expected a port of digits");
}

/// A cut as fine as the pixels of a small picture, from which a page has its first extinction, ranges and histograms.
HtmlModel model_of_site(const std::filesystem::path& folder, std::size_t n) {
    constexpr int kSize = 256;
    SiteCut cut(folder, n);
    Box box = cut.info().description.box;
    if (box.empty()) {
        const CutOptions coarsest{std::numeric_limits<double>::max(), false};
        box = view_box(cut.choose(frame_of(Camera{}, 1, 1), coarsest));
    }
    Gaussians coarse = cut.choose(frame_of(orbit_view(box), kSize, kSize), {1, false});
    coarse.box = box;
    coarse.source = cut.info().description.source;
    return {cut.info().name, {std::move(coarse)}};
}

}  // namespace

std::string web::allowed_origin(const HtmlSource& source) {
    const std::string_view url = source.url;
    if (url.empty()) refuse(source, "no address, expected one of https or http, or a relative one");
    for (const char letter : url)
        if (letter <= ' ' || letter >= 0x7f ||
            std::string_view("\"'<>\\^`{|}#").find(letter) != url.npos)
            refuse(source,
                   fmt::format("expected an address without {}, which addresses write as %{:02X}",
                               letter > ' ' && letter < 0x7f ? fmt::format("'{}'", letter)
                                                             : "such a character",
                               static_cast<unsigned char>(letter)));
    if (source.file && (url.ends_with('/') || url.find("/?") != url.npos))
        refuse(source, "a folder, expected the address of the compact file");
    if (!source.file && url.find('?') != url.npos)
        refuse(source, "an address with a query, expected that of a folder");
    const std::size_t scheme = scheme_end(url);
    if (scheme == 0) {
        if (url.starts_with("//"))
            refuse(source, "expected an address of https or http, or one without //");
        return "'self'";
    }
    std::string begin(url.substr(0, std::min(scheme + 2, url.size())));
    std::ranges::transform(begin, begin.begin(), [](char letter) {
        return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    });
    if (begin != "https://" && begin != "http://")
        refuse(source, "expected an address of https or http, or a relative one");
    const std::string_view rest = url.substr(begin.size());
    const std::string_view host = rest.substr(0, rest.find_first_of("/?"));
    if (host.find('@') != host.npos)
        refuse(source, "expected an address without a user or password");
    check_host(source, host);
    return begin + std::string(host);
}

std::vector<HtmlModel> models_to_stream(const std::filesystem::path& path) {
    std::vector<HtmlModel> models;
    if (is_site(path)) {
        const std::size_t count = read_site_info(path).models.size();
        for (std::size_t n = 0; n < count; ++n) models.push_back(model_of_site(path, n));
        return models;
    }
    const std::string why = read_vogz_info(path).not_streamed;
    if (!why.empty()) throw Error(fmt::format("{}: {}", path.string(), why));
    Hierarchy hierarchy;
    Gaussians model = read_vogz(path, &hierarchy);
    models.push_back(prepare_for_site(printable(path.stem().string()), model, hierarchy));
    return models;
}

}  // namespace vog
