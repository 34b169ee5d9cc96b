# cmake -DIN=x.ptx -DOUT=x.cpp -P embed_ptx.cmake: a file as the array vog::gpu::kOptixPrograms, with a
# final zero that its size counts too, as OptiX has it of text.
file(READ ${IN} bytes HEX)
string(LENGTH "${bytes}" digits)
math(EXPR size "${digits} / 2 + 1")
string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(................................................................................)" "\\1\n"
       bytes "${bytes}")
file(WRITE ${OUT} "// Made by embed_ptx.cmake from the OptiX programs' PTX.
#include <cstddef>
namespace vog::gpu {
extern const char kOptixPrograms[];
extern const std::size_t kOptixProgramsBytes;
const char kOptixPrograms[] = {
${bytes}0};
const std::size_t kOptixProgramsBytes = ${size};
}  // namespace vog::gpu
")
