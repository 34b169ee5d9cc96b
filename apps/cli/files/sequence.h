// sequence.h: time series: one output file per input, into a folder.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace vog::cli {

/// Expands file patterns with * or ?, so that quoted patterns work. Matches are in natural order:
/// frame_2 before frame_10. Names of existing files and names without * or ? stay, as do patterns of TIFF, slices of one volume.
/// throws vog::Error for a pattern that nothing matches
std::vector<std::string> expanded(const std::vector<std::string>& inputs);

/// Whether an output is a folder (or a name that ends in '/'): one file per input.
bool is_sequence(const std::string& output);

/// One input of a sequence and its output.
struct Frame {
    std::string input, output;
};
/// Outputs named after the inputs: in/frame_7.vdb -> out/frame_7.ply. Creates the folder.
/// throws vog::Error for a folder that cannot be created, two inputs of one name, an output that is
///        an input
std::vector<Frame> frames_of(const std::vector<std::string>& inputs, const std::string& folder,
                             const std::string& extension);

/// Whether the output is a whole model and newer than its input. A system that stopped may leave an
/// empty file.
bool is_fresh(const Frame& frame);

/// Runs work(frame) for every frame, concurrently as far as memory allows. The first error stops
/// it, after the frames that have begun.
/// memory  bytes; 0: one frame at a time
/// need    need(frame): estimated memory of one frame, bytes
void for_each_frame(const std::vector<Frame>& frames, std::uint64_t memory,
                    const std::function<std::uint64_t(const Frame&)>& need,
                    const std::function<void(const Frame&)>& work);

}  // namespace vog::cli
