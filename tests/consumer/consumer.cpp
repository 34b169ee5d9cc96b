// consumer.cpp: the README's lines, as a stranger would write them.
#include <vog/vog.h>

#include <cstdio>

int main() {
    const vog::Volume volume = vog::sample_cloud({.size = 64});
    const vog::Gaussians model = vog::convert_moments(volume, {.block_voxels = 4});
    vog::write_ply("cloud.ply", model);

    const vog::Picture picture = vog::render(vog::scene_of(model), {.width = 256, .height = 256});
    vog::write_png("cloud.png", picture.image);
    std::printf("%zu Gaussians, extinction %g\n", model.size(), picture.extinction);
    return model.size() > 0 && picture.extinction > 0 ? 0 : 1;
}
