// named_extinction.h: automatic extinction, with the name of the data in its errors.
#pragma once

#include <string>

#include "vog/error.h"
#include "vog/image.h"

namespace vog::shading {

/// source  file or model that the image shows; empty: unknown
/// throws  vog::Error as auto_extinction does, beginning with the source
inline double auto_extinction_of(const DepthImage& image, const std::string& source) {
    try {
        return auto_extinction(image);
    } catch (const Error& error) {
        throw Error((source.empty() ? "" : source + ": ") + error.what());
    }
}

}  // namespace vog::shading
