// model_part.h: run of Gaussians that is a part of a model's file.
#pragma once

#include <fmt/core.h>

#include <cstdint>
#include <string>
#include <utility>

#include "vog/distributed.h"
#include "vog/error.h"

namespace vog {

/// throws  vog::Error naming `where` for an index out of range
inline void require_part(const ModelPart& part, const std::string& where) {
    if (part.count < 1 || part.index < 0 || part.index >= part.count)
        throw Error(fmt::format(
            "{}: part {} of {}, expected an index from 0 to one less than the number of parts",
            where, part.index, part.count));
}

/// First Gaussian of a part, and the first behind it.
inline std::pair<std::uint64_t, std::uint64_t> run_of(const ModelPart& part, std::uint64_t count) {
    const auto first_of = [&](int index) {
        const auto i = static_cast<std::uint64_t>(index);
        const auto parts = static_cast<std::uint64_t>(part.count);
        return count / parts * i + count % parts * i / parts;
    };
    return {first_of(part.index), first_of(part.index + 1)};
}

}  // namespace vog
