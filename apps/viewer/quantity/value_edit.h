// value_edit.h: editing of transfer functions of values: points, window and level, maps, undo and redo. Functions from
// one to another, without state but the history.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "vog/shade.h"
#include "vog/value_transfer.h"
#include "vog/volume_picture.h"

namespace vog::viewer {

/// Ends of values.
struct ValueRange {
    double lower = 0, upper = 1;
    double width() const { return upper - lower; }
};
/// Range of all points, of colour and opacity.
ValueRange range_of(const ValueTransfer& transfer);

/// The transfer function with another map's colours over the range of its points, or its logarithms; opacity is kept.
ValueTransfer with_map(ValueTransfer transfer, const TransferFunction& map, bool log = false);
/// Colours in the reverse order, opacity kept.
ValueTransfer inverted(ValueTransfer transfer);
/// All points moved by `shift` and their distances from the middle multiplied by `factor` > 0: window and level, as
/// radiologists have them.
ValueTransfer windowed(ValueTransfer transfer, double shift, double factor);
/// Opacity point n at another place, between its neighbours; opacity clamped to [0, 1].
ValueTransfer with_point(ValueTransfer transfer, std::size_t n, ValueOpacity point);
/// One point more, in order.
/// index  receives its place
ValueTransfer with_new_point(ValueTransfer transfer, ValueOpacity point, std::size_t& index);
/// One point less; the last one stays.
ValueTransfer without_point(ValueTransfer transfer, std::size_t n);
/// Opacity points first to last moved together, between their neighbours; opacities multiplied.
/// shift   of values
/// factor  of opacities, >= 0
ValueTransfer with_band_moved(ValueTransfer transfer, std::size_t first, std::size_t last,
                              double shift, double factor);
/// Points of one band of equal opacity around point n: the plateau and its feet, as a band of `--band` has them;
/// the point alone where its neighbours have other opacities.
struct PointRange {
    std::size_t first = 0, last = 0;
};
PointRange band_around(const ValueTransfer& transfer, std::size_t n);
/// Opacity that falls from 1 to 0 and rises again is replaced by one that rises over a range.
ValueTransfer ramp(ValueTransfer transfer, ValueRange range);
/// A peak of opacity: a tent about the middle of a range, a quarter of it wide.
ValueTransfer peak(ValueTransfer transfer, ValueRange range);
/// A step at the middle of a range: nothing below.
ValueTransfer step(ValueTransfer transfer, ValueRange range);

/// Transfer functions, and directions of lights, as they were edited.
class ValueHistory {
  public:
    /// The present one; null: none yet.
    const std::shared_ptr<const ValueTransfer>& now() const { return now_; }
    /// Forgets all but this one.
    void begin(ValueTransfer transfer);
    /// A change. Changes of one drag count as one: those between begin_drag and end_drag.
    void change(ValueTransfer transfer);
    /// Before a change of the lights.
    void change_lights(const std::vector<DirectionalLight>& lights);
    void begin_drag() { dragging_ = true, drag_kept_ = false; }
    void end_drag() { dragging_ = false; }
    bool can_undo() const { return !before_.empty(); }
    bool can_redo() const { return !after_.empty(); }
    /// lights  the present ones, which those of the step replace
    void undo(std::vector<DirectionalLight>& lights) { step(before_, after_, lights); }
    void redo(std::vector<DirectionalLight>& lights) { step(after_, before_, lights); }

  private:
    struct Step {
        std::shared_ptr<const ValueTransfer> transfer;
        std::optional<std::vector<DirectionalLight>> lights;  ///< nothing: not changed
    };
    void keep(Step before);
    void step(std::vector<Step>& from, std::vector<Step>& to,
              std::vector<DirectionalLight>& lights);
    std::shared_ptr<const ValueTransfer> now_;
    std::vector<Step> before_, after_;
    bool dragging_ = false, drag_kept_ = false;
};

}  // namespace vog::viewer
