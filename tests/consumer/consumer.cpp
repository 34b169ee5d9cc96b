// consumer.cpp: the README's ten lines, as a stranger would write them.
#include <vog/vog.h>

#include <cstdio>

int main() {
    const vog::Volume volume = vog::sample_cloud({.size = 64});
    const vog::Gaussians model = vog::convert_moments(volume, {.block_voxels = 4});
    vog::write_ply("cloud.ply", model);

    vog::DepthImage depth = vog::render_splat(model, vog::paper_view(model.box), 256, 256);
    vog::set_extinction(depth, vog::auto_extinction(depth));
    const vog::Image image = vog::shade(depth, vog::named_transfer_function("blue-white"));
    vog::write_png("cloud.png", image);
    std::printf("%zu Gaussians, extinction %g\n", model.size(), depth.extinction);
    return model.size() > 0 && depth.extinction > 0 ? 0 : 1;
}
