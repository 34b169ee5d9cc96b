// refused_files.h: checks of readers with bad, truncated and changed files.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "support/data.h"
#include "support/image_bytes.h"
#include "vog/error.h"

namespace vog::test {

/// Message of the vog::Error that `call` throws; a test failure if it throws none.
template <class Call>
std::string error_of(Call call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    ADD_FAILURE() << "no error";
    return "";
}

/// Expects reading to fail with one line that starts with the file's name and contains `words`.
template <class Read>
void expect_refused(const std::string& bytes, Read read, const std::string& words) {
    const TempDir dir;
    const auto file = dir / "refused.img";
    write_bytes(file, bytes);
    const std::string message = error_of([&] { read(file); });
    EXPECT_EQ(message.find(file.string()), 0u) << message;
    EXPECT_NE(message.find(words), std::string::npos) << message << "\nexpected: " << words;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

/// Expects that every truncation of the file is refused, and that nothing is printed.
template <class Read>
void expect_all_truncations_refused(const std::string& bytes, Read read) {
    const TempDir dir;
    const auto file = dir / "cut.img";
    testing::internal::CaptureStderr();
    for (std::size_t size = 0; size < bytes.size(); ++size) {
        write_bytes(file, bytes.substr(0, size));
        EXPECT_THROW(read(file), Error) << size << " of " << bytes.size() << " bytes";
    }
    write_bytes(file, bytes);
    EXPECT_NO_THROW(read(file));
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

/// Expects that a file with any one byte changed is refused or read, and that nothing is printed.
template <class Read>
void expect_survives_changed_bytes(const std::string& bytes, Read read) {
    const TempDir dir;
    const auto file = dir / "changed.img";
    testing::internal::CaptureStderr();
    for (std::size_t i = 0; i < bytes.size(); ++i)
        for (const int change : {0x01, 0x80, 0xff}) {
            std::string changed = bytes;
            changed[i] = static_cast<char>(changed[i] ^ change);
            write_bytes(file, changed);
            try {
                read(file);
            } catch (const Error&) {
            }
        }
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace vog::test
