// sequence.h: many inputs, one output each: time steps to a folder.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace vog::cli {

/// Names of files, where a word that names none is a pattern with * or ?: all that match, so that
/// quoted patterns work, in natural order: frame_2 before frame_10.
/// throws vog::Error for a pattern that nothing matches
std::vector<std::string> expanded(const std::vector<std::string>& inputs);

/// Whether an output stands for a file an input: a folder (or a name that ends in '/').
bool is_sequence(const std::string& output);

/// One input of a sequence and what is made of it.
struct Frame {
    std::string input, output;
};
/// Outputs by the names of the inputs: in/frame_7.vdb -> out/frame_7.ply. Makes the folder.
/// throws vog::Error for a folder that cannot be made, two inputs of one name, an output that is
///        an input
std::vector<Frame> frames_of(const std::vector<std::string>& inputs, const std::string& folder,
                             const std::string& extension);

/// Whether the output is there already and newer than its input.
bool is_fresh(const Frame& frame);

/// Runs work(frame) for each, as many at a time as fit `memory` by need(frame), in bytes; one at a
/// time where memory is 0. The first error ends it, after the frames that had begun.
void for_each_frame(const std::vector<Frame>& frames, std::uint64_t memory,
                    const std::function<std::uint64_t(const Frame&)>& need,
                    const std::function<void(const Frame&)>& work);

}  // namespace vog::cli
