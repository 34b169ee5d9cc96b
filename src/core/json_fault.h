// json_fault.h: faults of JSON files in words, without the library's names for them.
#pragma once

#include <fmt/core.h>

#include <nlohmann/json.hpp>
#include <string>

namespace vog {

/// "not JSON from byte 17 on", "no key 'eye'", "a value of another type than expected".
inline std::string json_fault(const nlohmann::json::exception& error) {
    if (const auto* parse = dynamic_cast<const nlohmann::json::parse_error*>(&error))
        return fmt::format("not JSON from byte {} on", parse->byte);
    // "[json.exception.out_of_range.403] key 'eye' not found"
    const std::string text = error.what();
    const std::size_t begin = text.find('\''), end = text.rfind('\'');
    constexpr int kMissingKey = 403;
    if (error.id == kMissingKey && begin < end)
        return fmt::format("no key {}", text.substr(begin, end - begin + 1));
    return "a value of another type than expected";
}

}  // namespace vog
