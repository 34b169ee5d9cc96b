// refusal.h: The message of a vog::Error.
#pragma once

#include <string>

#include "vog/error.h"

namespace vog::test {

/// The message of make()'s error; "no error" if there is none.
template <class Make>
std::string refusal(const Make& make) {
    try {
        make();
    } catch (const Error& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace vog::test
