// box_kernels.cpp: Chords of rays through voxels, a SIMD vector of pixels at a time, in double precision.
// foreach_target.h includes this file once per target: code outside HWY_NAMESPACE is guarded.
#include "render/reference/fields/box_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/reference/fields/box_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vog::reference {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, BoxTile::kMaxLanes>;
using Lanes = hn::Vec<Tag>;

HWY_INLINE void add_box(const PixelBox& box, BoxTile& tile) {
    const Tag d;
    const Lanes zero = hn::Zero(d);
    const Lanes weight = hn::Set(d, box.weight), value = hn::Set(d, box.value);
    const Lanes enter_x = hn::Set(d, box.enter[0]), leave_x = hn::Set(d, box.leave[0]);
    const Lanes enter_y = hn::Set(d, box.enter[1]), leave_y = hn::Set(d, box.leave[1]);
    const Lanes enter_z = hn::Set(d, box.enter[2]), leave_z = hn::Set(d, box.leave[2]);
    const int lanes = static_cast<int>(hn::Lanes(d));
    for (int y = box.y0; y <= box.y1; ++y)
        for (int x = box.x0 & -lanes; x <= box.x1; x += lanes) {
            const Lanes shift_x = hn::Load(d, &tile.shift[0][y][x]);
            const Lanes shift_y = hn::Load(d, &tile.shift[1][y][x]);
            const Lanes shift_z = hn::Load(d, &tile.shift[2][y][x]);
            const Lanes enter =
                hn::Max(hn::Max(hn::Add(enter_x, shift_x), hn::Add(enter_y, shift_y)),
                        hn::Max(hn::Add(enter_z, shift_z), zero));
            const Lanes leave =
                hn::Min(hn::Min(hn::Add(leave_x, shift_x), hn::Add(leave_y, shift_y)),
                        hn::Add(leave_z, shift_z));
            const auto hit = hn::Lt(enter, leave);
            const Lanes part = hn::IfThenElseZero(hit, hn::Mul(weight, hn::Sub(leave, enter)));
            const Lanes column = hn::Load(d, &tile.column[y][x]);
            Lanes reference = hn::Load(d, &tile.reference[y][x]);
            reference = hn::IfThenElse(hn::And(hit, hn::Eq(column, zero)), value, reference);
            const Lanes difference = hn::IfThenElseZero(hit, hn::Sub(value, reference));
            const Lanes first = hn::Mul(part, difference);
            hn::Store(reference, d, &tile.reference[y][x]);
            hn::Store(hn::Add(column, part), d, &tile.column[y][x]);
            hn::Store(hn::Add(hn::Load(d, &tile.first[y][x]), first), d, &tile.first[y][x]);
            hn::Store(hn::Add(hn::Load(d, &tile.second[y][x]), hn::Mul(first, difference)), d,
                      &tile.second[y][x]);
        }
}

void add_all_boxes(const PixelBox* boxes, std::size_t count, BoxTile& tile) {
    for (std::size_t n = 0; n < count; ++n) add_box(boxes[n], tile);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vog::reference
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vog::reference {

namespace {
HWY_EXPORT(add_all_boxes);
}  // namespace

void add_boxes(const PixelBox* boxes, std::size_t count, BoxTile& tile) {
    HWY_DYNAMIC_DISPATCH(add_all_boxes)(boxes, count, tile);
}

}  // namespace vog::reference
#endif  // HWY_ONCE
