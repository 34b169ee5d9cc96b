// gpu_pictures_state.h: A model of GpuPictures in GPU memory, and the buffers of its pictures.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/gpu/chords/chord_tracer.h"
#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/cuda_memory.h"
#include "render/gpu/cuda_passes.h"
#include "render/gpu/sums/sums_memory.h"
#include "render/light/illumination.h"
#include "render/shown_field.h"
#include "render/trace/trace_model.h"

namespace vog {

struct GpuPictures::State {
    Renderer renderer;
    const Gaussians& gaussians;
    trace::TraceModel model;  ///< without its arrays, which are on the GPU
    std::int32_t count = 0;
    gpu::GpuArray<device::Gaussian> packed;
    std::unique_ptr<gpu::ChordTracer> tracer;  ///< of optix
    gpu::SplatPasses passes;
    gpu::GpuArray<float> shares, result;
    gpu::GpuArray<device::SplatDepth> depths;
    gpu::GpuArray<std::uint32_t> range;
    gpu::GpuArray<device::HalfSpace> planes;
    gpu::GpuArray<device::ScalarPlane> scalar;
    gpu::GpuArray<device::VectorPlane> vector;
    std::optional<std::pair<FieldChoice, ShownField>> shown;  ///< of `scalar` and `vector`
    gpu::GpuArray<device::SplatValue> splat_values;
    std::optional<std::string> values_field;  ///< whose `splat_values` are
    gpu::GpuArray<device::LightPiece> pieces;
    gpu::GpuArray<float> table;
    by_value::LightOfMoments made_light;
    device::MeanLight light{};                                      ///< of `pieces` and `table`
    std::optional<std::pair<std::string, ValueTransfer>> light_of;  ///< field and transfer function
    int lights_made = 0;
    lights::KeptIllumination reached;
    gpu::GpuArray<float> direct, ambient, opaque;  ///< of `reached`
    gpu::GpuTimer timer;

    State(Renderer by, const Gaussians& of, trace::TraceModel packed_model)
        : renderer(by), gaussians(of), model(std::move(packed_model)) {}
    CameraFrame frame_for(const Camera& camera, int width, int height) const {
        return relative_to(frame_of(camera, width, height), model.origin);
    }
    /// throws  vog::Error for rays out of range, too
    CameraFrame frame_for(const Camera& camera, const SumsSize& size) const {
        return frame_for(camera, gpu::lattice(size, &SumsSize::width),
                         gpu::lattice(size, &SumsSize::height));
    }
    device::ChordPicture begin(const CameraFrame& frame, const Clipping& clip);
    ShownField load_field(const FieldChoice& choice, const CameraFrame& frame);
    void load_values(const ScalarField& field);
    void load_light(const ScalarField& field, const ValueTransfer& transfer);
    device::LightLattice load_reached(const ScalarField& field, const VolumeLook& look,
                                      Vec3d forward);
    /// Projects the model and draws; the result is [floats a pixel] in `result`.
    void draw(device::ChordPicture picture);
    /// Draws a model that is not empty; the result is column, or column, mean and deviation in the unit of the shown field.
    void draw_depth(const CameraFrame& frame, const Clipping& clip);
    void draw_fields(const CameraFrame& frame, const Clipping& clip);
    /// by  null: the maximum
    void draw_slabs(const ScalarField& field, const ValueTransfer* by, const CameraFrame& frame,
                    int slabs, const VolumeLook& look);
    /// The scalar field of a picture by value. throws vog::Error for slabs out of range, a field that the model lacks
    const ScalarField& slab_field(const std::string& field, int slabs) const;
    void fetch(float* to, std::size_t floats) const {
        result.copy_to(to, floats, "fetching the picture");
    }
    std::vector<float> fetch(std::size_t floats) const {
        std::vector<float> values(floats);
        fetch(values.data(), floats);
        return values;
    }
};

}  // namespace vog
