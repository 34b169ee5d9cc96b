// tiff_handle.h: open TIFF of libtiff, its faults and tags.
#pragma once

#include <fmt/format.h>
#include <tiffio.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/atomic_file.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

/// Open file whose faults become messages; the library prints nothing.
struct Tiff {
    std::string name, fault;
    std::optional<std::uint16_t> other_unit{};  ///< ResolutionUnit that libtiff does not know
    std::unique_ptr<TIFF, void (*)(TIFF*)> handle{nullptr, TIFFClose};

    explicit Tiff(const std::filesystem::path& file) : name(file.string()) {
        require_readable(file);
        TIFFOpenOptions* options = TIFFOpenOptionsAlloc();
        TIFFOpenOptionsSetErrorHandlerExtR(
            options,
            [](TIFF*, void* self, const char*, const char* format, va_list values) {
                char text[200];
                std::vsnprintf(text, sizeof text, format, values);
                static_cast<Tiff*>(self)->hear(text);
                return 1;
            },
            this);
        TIFFOpenOptionsSetWarningHandlerExtR(
            options, [](TIFF*, void*, const char*, const char*, va_list) { return 1; }, nullptr);
        // No single table or strip of a lie in the head; pictures of 2^29 bytes a strip are rare.
        TIFFOpenOptionsSetMaxSingleMemAlloc(options, tmsize_t{1} << 29);
        handle.reset(TIFFOpenExt(name.c_str(), "rm", options));
        TIFFOpenOptionsFree(options);
        if (!handle) fail("cannot be opened");
    }
    Tiff(Tiff&&) = delete;

    void hear(const std::string& text) {
        const std::size_t value = text.find("Bad value ");
        if (value != text.npos && text.find("\"ResolutionUnit\"") != text.npos)
            other_unit = static_cast<std::uint16_t>(std::atoi(text.c_str() + value + 10));
        else if (fault.empty())
            fault = text;
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}{}, expected a TIFF of integers or floats", name, what,
                                fault.empty() ? "" : " (" + printable(fault, 120) + ")"));
    }
    template <class T>
    T tag(std::uint32_t which, T otherwise) const {
        T value = otherwise;
        TIFFGetFieldDefaulted(handle.get(), which, &value);
        return value;
    }
    std::string text(std::uint32_t which) const {
        const char* value = nullptr;
        return TIFFGetField(handle.get(), which, &value) && value ? value : "";
    }
    /// Numbers of a tag that libtiff does not know.
    template <class T>
    std::span<const T> numbers(std::uint32_t which, TIFFDataType type) const {
        std::uint32_t count = 0;
        const T* values = nullptr;
        if (TIFFFindField(handle.get(), which, type))
            TIFFGetField(handle.get(), which, &count, &values);
        return {values, values ? count : 0};
    }
};

}  // namespace vog::scan
