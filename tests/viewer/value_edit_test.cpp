// value_edit_test.cpp: edits of transfer functions of values, their history, and the probe of a volume.
#include "quantity/value_edit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "quantity/probe.h"
#include "support/data.h"

namespace vog::test {

using namespace viewer;

namespace {

ValueTransfer sample_transfer() {
    return {"two", {{10, 1, 0, 0}, {30, 0, 0, 1}}, {{10, 0}, {20, 0.5}, {30, 1}}, 2};
}

}  // namespace

TEST(value_edit, a_window_keeps_opacities_and_scales_values) {
    const ValueTransfer moved = windowed(sample_transfer(), 5, 2);
    EXPECT_EQ(moved.color.front().value, 5);
    EXPECT_EQ(moved.color.back().value, 45);
    EXPECT_EQ(moved.opacity[1], (ValueOpacity{25, 0.5}));
    EXPECT_EQ(moved.unit_distance, 2);
    // And back.
    EXPECT_EQ(windowed(moved, -5, 0.5), sample_transfer());
}

TEST(value_edit, maps_span_the_points_and_inversion_is_its_own_inverse) {
    const ValueTransfer other = with_map(sample_transfer(), named_transfer_function("viridis"));
    EXPECT_EQ(other.color.front().value, 10);
    EXPECT_EQ(other.color.back().value, 30);
    EXPECT_EQ(other.opacity, sample_transfer().opacity);
    EXPECT_EQ(inverted(sample_transfer()).color.front(), (ValueColor{10, 0, 0, 1}));
    EXPECT_EQ(inverted(inverted(sample_transfer())), sample_transfer());
}

TEST(value_edit, points_stay_between_their_neighbours) {
    EXPECT_EQ(with_point(sample_transfer(), 1, {99, 2}).opacity[1], (ValueOpacity{30, 1}));
    EXPECT_EQ(with_point(sample_transfer(), 1, {-9, -2}).opacity[1], (ValueOpacity{10, 0}));
    std::size_t index = 0;
    const ValueTransfer more = with_new_point(sample_transfer(), {25, 0.1}, index);
    EXPECT_EQ(index, 2u);
    EXPECT_EQ(without_point(more, index), sample_transfer());
    ValueTransfer one = sample_transfer();
    one.opacity.resize(1);
    EXPECT_EQ(without_point(one, 0), one);
}

TEST(value_edit, a_band_moves_as_one_up_to_its_neighbours) {
    ValueTransfer bands = sample_transfer();
    bands.opacity = {{0, 0}, {10, 0}, {10, 0.8}, {14, 0.8}, {14, 0}, {30, 0}};
    const PointRange band = band_around(bands, 2);
    EXPECT_EQ(band.first, 1u);
    EXPECT_EQ(band.last, 4u);
    const ValueTransfer moved = with_band_moved(bands, band.first, band.last, 3, 0.5);
    EXPECT_EQ(moved.opacity[1], (ValueOpacity{13, 0}));
    EXPECT_EQ(moved.opacity[2], (ValueOpacity{13, 0.4}));
    EXPECT_EQ(moved.opacity[4], (ValueOpacity{17, 0}));
    EXPECT_EQ(with_band_moved(bands, band.first, band.last, 99, 1).opacity[4].value, 30);
    // A ramp's points are no band.
    EXPECT_EQ(band_around(sample_transfer(), 1).first, 1u);
    EXPECT_EQ(band_around(sample_transfer(), 1).last, 1u);
}

TEST(value_edit, presets_are_valid) {
    for (const ValueTransfer& preset :
         {ramp(sample_transfer(), {-5, 5}), peak(sample_transfer(), {-5, 5}),
          step(sample_transfer(), {-5, 5})}) {
        validate(preset);
        EXPECT_EQ(preset.opacity.front().value, -5);
        EXPECT_EQ(preset.opacity.back().value, 5);
    }
}

TEST(value_edit, a_drag_is_one_step_of_the_history) {
    ValueHistory history;
    std::vector<DirectionalLight> lights;
    EXPECT_FALSE(history.now());
    history.begin(sample_transfer());
    history.undo(lights);
    EXPECT_EQ(*history.now(), sample_transfer());
    history.begin_drag();
    for (const double shift : {1.0, 2.0, 3.0})
        history.change(windowed(sample_transfer(), shift, 1));
    history.end_drag();
    history.change(windowed(sample_transfer(), 7, 1));
    const auto kept = history.now();
    history.undo(lights);
    EXPECT_EQ(*history.now(), windowed(sample_transfer(), 3, 1));
    history.undo(lights);
    EXPECT_EQ(*history.now(), sample_transfer());
    EXPECT_FALSE(history.can_undo());
    history.redo(lights);
    history.redo(lights);
    EXPECT_EQ(history.now(), kept);
    EXPECT_FALSE(history.can_redo());
    // Another edit forgets what was undone.
    history.undo(lights);
    history.change(sample_transfer());
    EXPECT_FALSE(history.can_redo());
}

TEST(value_edit, drags_of_a_light_are_steps_beside_those_of_values) {
    ValueHistory history;
    history.begin(sample_transfer());
    std::vector<DirectionalLight> lights;
    history.begin_drag();
    for (const double x : {1.0, 2.0, 3.0}) {
        history.change_lights(lights);
        lights = {{{x, 0, 1}}};
    }
    history.end_drag();
    const auto dragged = lights;
    history.change(windowed(sample_transfer(), 7, 1));
    history.undo(lights);
    EXPECT_EQ(*history.now(), sample_transfer());
    EXPECT_EQ(lights, dragged);
    history.undo(lights);
    EXPECT_TRUE(lights.empty());
    EXPECT_FALSE(history.can_undo());
    history.redo(lights);
    history.redo(lights);
    EXPECT_EQ(lights, dragged);
    EXPECT_EQ(*history.now(), windowed(sample_transfer(), 7, 1));
}

TEST(value_edit, a_written_transfer_function_is_read_again) {
    TempDir dir;
    const ValueTransfer written = sample_transfer();
    write_value_transfer(dir / "look.json", written);
    EXPECT_EQ(read_value_transfer((dir / "look.json").string(), 0, 1, 99), written);
}

TEST(value_edit, the_probe_finds_where_a_gaussian_is_half_opaque) {
    // One Gaussian whose value rises along x; extinction 1 a unit of density at any value.
    Gaussians model;
    model.mean.push_back({0, 0, 0});
    model.scale.push_back({1, 1, 1});
    model.density.push_back(2);
    model.box = {{-3, -3, -3}, {3, 3, 3}};
    model.cutoff = 3;
    ScalarField field;
    field.name = "t";
    field.lower = -30, field.upper = 50;
    field.value.push_back(10);
    field.gradient.push_back({10, 0, 0});
    field.deviation.push_back(0);
    field.skewness.push_back(0);
    const ValueTransfer all{"all", {{0, 1, 1, 1}}, {{0, -std::expm1(-1.0)}}, 1};
    const auto found = first_opaque_value(model, field, all, {}, {-9, 0, 0}, {2, 0, 0});
    ASSERT_TRUE(found);
    // The integral of 2 exp(-x^2 / 2) from -3 is ln 2 at -1.082; steps are a quarter of the deviation.
    EXPECT_NEAR(found->distance, 9 - 1.082, 0.15);
    EXPECT_NEAR(found->value, 10 + 10 * (found->distance - 9), 0.2);
    // Beside it, and where a clip leaves little: clear.
    EXPECT_FALSE(first_opaque_value(model, field, all, {}, {-9, 5, 0}, {1, 0, 0}));
    Clipping clip;
    clip.box = Box{{1.5, -3, -3}, {3, 3, 3}};
    EXPECT_FALSE(first_opaque_value(model, field, all, clip, {-9, 0, 0}, {1, 0, 0}));
}

}  // namespace vog::test
