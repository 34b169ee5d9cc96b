// optix_test.cpp: GPU renderers on machines without a GPU: entry points of the device module, and
// messages that name the missing part.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "render/gpu/gpu.h"
#include "render/gpu/optix/optix_entry_points.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"

namespace vog::test {

using namespace vog::gpu;

#ifdef VOG_OPTIX

TEST(optix, the_device_module_has_every_entry_point) {
    const std::string ptx(kOptixPrograms, kOptixProgramsBytes - 1);
    ASSERT_EQ(kOptixPrograms[kOptixProgramsBytes - 1], 0);
    std::set<std::string> entries;
    const std::string key = ".entry ";
    for (std::size_t at = ptx.find(key); at != std::string::npos; at = ptx.find(key, at + 1)) {
        const std::size_t name = at + key.size();
        entries.insert(ptx.substr(name, ptx.find_first_of("(\n ", name) - name));
    }
    EXPECT_FALSE(entries.contains("__raygen__nothing"));
    for (const OptixEntryPoints& points :
         {kAccumulateEntryPoints, kCollectEntryPoints, kVoxelEntryPoints})
        for (const char* name :
             {points.raygen, points.miss, points.intersection, points.anyhit, points.closesthit}) {
            if (name) {
                EXPECT_TRUE(entries.contains(name)) << name;
            }
        }
    // OptiX finds the launch parameters by name too.
    EXPECT_NE(ptx.find(" launch["), std::string::npos);
}

#else

TEST(optix, the_device_module_has_every_entry_point) {
    GTEST_SKIP() << "built without VOG_OPTIX: no device code to look into";
}

#endif

TEST(optix, the_missing_part_is_named_in_one_line) {
    const Gaussians model = random_gaussians(3, 0.1, 0.2, 1);
    const std::string lines[] = {refusal([&] { CudaSplat splat(model); }),
                                 refusal([&] { OptixModel traced(model); })};
    if (lines[0] == "no error") GTEST_SKIP() << "there is a GPU here: nothing is missing";
    for (const std::string& line : lines) {
        EXPECT_EQ(line.find('\n'), std::string::npos) << line;
        EXPECT_TRUE(line.starts_with("cuda: ") || line.starts_with("optix: ")) << line;
    }
}

TEST(optix, an_invalid_model_is_refused_with_or_without_a_gpu) {
    Gaussians model = random_gaussians(3, 0.1, 0.2, 1);
    model.density[0] = -1;
    EXPECT_THROW(CudaSplat splat(model), Error);
    EXPECT_THROW(OptixModel traced(model), Error);
}

}  // namespace vog::test
