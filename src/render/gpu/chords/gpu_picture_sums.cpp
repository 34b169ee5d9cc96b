// gpu_picture_sums.cpp: Pictures of GpuPictures that stay in GPU memory.
#include "render/by_value/volume_field.h"
#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/chords/gpu_pictures_state.h"
#include "render/gpu/sums/sums_memory.h"

namespace vog {

using namespace gpu;
using namespace trace;

void GpuPictures::depth(const Camera& camera, const SumsSize& size, GpuSums& sums,
                        const Clipping& clip) {
    State& s = *state_;
    const CameraFrame frame = s.frame_for(camera, size);
    validate(clip);
    SumsPass pass = sums.state().prepare(SumsKind::depth, size, 4);
    if (s.count == 0) return sums.state().clear();
    s.draw_depth(frame, clip);
    pass.from = s.result.data();
    GpuSums::State::finish(pass);
}

void GpuPictures::fields(const FieldChoice& choice, const SumsUnit& unit, const Camera& camera,
                         const SumsSize& size, GpuSums& sums, const Clipping& clip) {
    State& s = *state_;
    const CameraFrame frame = s.frame_for(camera, size);
    validate(clip);
    std::vector<FieldPart> parts{choice.part};
    if (choice.part == FieldPart::magnitude) parts = {FieldPart::x, FieldPart::y, FieldPart::z};
    SumsPass pass = sums.state().prepare(SumsKind::field, size, 4);
    pass.magnitude = parts.size() > 1 ? 1 : 0;
    double ms = 0;
    for (const FieldPart part : parts) {
        const ShownField shown = s.load_field({choice.field, part}, frame);
        if (s.count == 0) return sums.state().clear();
        s.draw_fields(frame, clip);
        ms += s.timer.ms();
        pass.from = s.result.data();
        pass.scale = shown.unit / unit.unit;
        pass.offset = ((shown.along_rays ? 0.0 : shown.reference.x) - unit.reference) / unit.unit;
        pass.reference = plain(shown.along_rays ? (1 / unit.unit) * shown.reference : Vec3d{});
        pass.camera = scene_camera(frame, s.model.unit);
        GpuSums::State::finish(pass);
        pass.more = 1;
    }
    s.timer.set_ms(ms);
}

void GpuPictures::volume(const std::string& field, const ValueTransfer& transfer,
                         const Camera& camera, const SumsSize& size, GpuSums& sums, int slabs,
                         const VolumeLook& look) {
    State& s = *state_;
    const ScalarField& values = s.slab_field(field, slabs);
    validate(look);
    validate(transfer);
    const CameraFrame frame = s.frame_for(camera, size);
    SumsPass pass = sums.state().prepare(SumsKind::colors, size, 4);
    if (s.count == 0) return sums.state().clear();
    s.draw_slabs(values, &transfer, frame, slabs, look);
    pass.from = s.result.data();
    GpuSums::State::finish(pass);
}

void GpuPictures::maximum(const std::string& field, const SumsUnit& unit, const Camera& camera,
                          const SumsSize& size, GpuSums& sums, int slabs, const Clipping& clip) {
    State& s = *state_;
    const ScalarField& values = s.slab_field(field, slabs);
    VolumeLook look;
    look.clip = clip;
    validate(clip);
    const CameraFrame frame = s.frame_for(camera, size);
    SumsPass pass = sums.state().prepare(SumsKind::maximum, size, 4);
    if (s.count == 0) return sums.state().clear();
    s.draw_slabs(values, nullptr, frame, slabs, look);
    pass.from = s.result.data();
    // As value_of_share.
    pass.offset = (values.lower - unit.reference) / unit.unit;
    pass.scale = (values.upper - values.lower) / unit.unit;
    GpuSums::State::finish(pass);
}

}  // namespace vog
