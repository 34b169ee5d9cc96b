// vog/renderer.h: All renderers: names, what each draws, and the options of all.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "vog/clip.h"
#include "vog/progress.h"

namespace vog {

/// Algorithms that draw pictures.
enum class Renderer {
    splat,      ///< Gaussians on the CPU, in object order, exact (docs/method.md)
    trace,      ///< Gaussians on the CPU, by the paper's rays (docs/ray_tracing.md)
    cuda,       ///< Gaussians on an NVIDIA GPU, as splat (docs/gpu.md)
    optix,      ///< Gaussians and voxels on an NVIDIA GPU, by the paper's two pipelines
    reference,  ///< voxels and cells on the CPU, exact for voxels of constant value: the ground truth
};

/// Data of one kind. Particles are Gaussians, one each.
enum class RenderInput {
    gaussians,
    volumes,  ///< one, or several that add up
    levels,   ///< levels of an adaptive mesh
    cells,    ///< cells of any shape
};

/// Facts about a renderer.
struct RendererInfo {
    Renderer renderer;
    const char* name;                ///< "splat"
    const char* description;         ///< "models and particles, exact, object order"
    bool built;                      ///< false: this build lacks CUDA or OptiX
    std::vector<RenderInput> draws;  ///< data it can draw
};
/// All renderers, also those that this build lacks, in the order to offer them in.
std::span<const RendererInfo> renderers();
/// Facts about one renderer.
const RendererInfo& info_of(Renderer renderer);
/// Whether a renderer can draw data of this kind.
bool draws(Renderer renderer, RenderInput input);
/// throws vog::Error naming all renderers
Renderer renderer_named(std::string_view name);
/// The renderer of this name for this input; empty: splat for Gaussians, else reference.
/// throws vog::Error naming the renderers for this input
Renderer renderer_for(std::string_view name, RenderInput input);

/// SIMD targets of the splat renderer that this machine can run, best first: "AVX2", ..., "scalar".
std::vector<std::string> splat_targets();

/// Any-hit program: the treatment of each intersection of a ray with a Gaussian.
enum class AnyHit {
    accumulate,  ///< adds its optical depth at once: T is a sum, independent of order
    collect,     ///< the paper's: gathers hits, sorts them by entry, integrates front to back
};

/// Options of rays through Gaussians.
struct TraceOptions {
    AnyHit anyhit = AnyHit::accumulate;  ///< treatment of hits
    int hits_per_slab = 64;  ///< capacity of the hit buffer of a collecting ray, [1, 256]
    /// Transmittance exp(-extinction T) below which a collecting ray ends, [0, 1); 0: never. The
    /// paper's `if T > 0.999 or T < 0.001, break`, read as transmittance, is 0.001.
    double stop_transmittance = 0;
    double extinction = 1;  ///< factor on density in the transmittance, > 0
    Progress progress{};    ///< called with the finished fraction of the picture
};

/// Counts over the rays of one picture.
struct TraceReport {
    std::uint64_t hits = 0;   ///< Gaussians added, summed over all rays
    std::uint64_t slabs = 0;  ///< hit buffers integrated by collecting rays, summed over all rays
    int most_slabs = 0;       ///< largest number of slabs of one ray
};

/// Field between voxel centres.
enum class Interpolation {
    constant,  ///< each active voxel fills its box [i-1/2, i+1/2]^3 with its value
    linear,    ///< trilinear between voxel centres, inactive voxels being 0
};

/// Interpolation of the reference.
struct VoxelGridOptions {
    Interpolation interpolation = Interpolation::constant;
    /// Spacing of samples along a ray, in voxels, for linear interpolation (midpoint rule, error
    /// proportional to its square). 0: exact, two Gauss points in each cell between voxel centres,
    /// where the field along a ray is a cubic.
    double step_voxels = 0.25;
};

/// Options of all renderers; one that the chosen renderer lacks is an error.
struct RenderOptions {
    /// Half edges of the paper's bounding boxes, in its radii (scale sqrt(2)), >= 0; 0: no boxes.
    /// For splat, trace and optix.
    double aabb_sigma = 0;
    /// Share of its peak at which a kernel is cut, [1.3e-14, 1); 0: at the model's own cutoff. For
    /// all renderers of Gaussians.
    double kappa = 0;
    /// Largest error of a drawn node of a hierarchy, pixels, >= 0; none: CutOptions' default for splat, and all Gaussians
    /// for cuda and optix. Not for trace.
    std::optional<double> pixel_error{};
    /// Any-hit program, hits per slab and end of rays of trace and optix; progress is not used.
    TraceOptions trace{};
    VoxelGridOptions voxels{};  ///< interpolation and step of the reference
    /// N: a pixel is the mean of N x N rays, through the centres of N x N equal parts of it, [1, 64]. For reference and optix.
    int samples = 1;
    Clipping clip{};  ///< space that counts; for all renderers
};

}  // namespace vog
