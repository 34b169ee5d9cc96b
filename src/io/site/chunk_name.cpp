// chunk_name.cpp: XXH3 by Debian's libxxhash-dev, whose header holds all of it.
#include "io/site/chunk_name.h"

#include <fmt/core.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <memory>

namespace vog::site {

std::string content_name(std::span<const std::string> contents) {
    const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                                XXH3_freeState);
    XXH3_128bits_reset(state.get());
    for (const std::string& bytes : contents)
        XXH3_128bits_update(state.get(), bytes.data(), bytes.size());
    const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

bool is_content_name(std::string_view text) {
    constexpr std::size_t kDigits = 32;
    return text.size() == kDigits && std::ranges::all_of(text, [](char c) {
               return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
           });
}

}  // namespace vog::site
