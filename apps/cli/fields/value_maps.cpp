// value_maps.cpp: pictures and figures of maps of values.
#include "fields/value_maps.h"

#include <algorithm>
#include <cmath>

namespace vog::cli {

Image map_picture(const RenderArguments& arguments, const ValueMap& map, const TransferFunction& tf,
                  const ColorScale& scale, const std::string& label) {
    const ShadeOptions shading = shading_of(arguments.color);
    const Image image = shade_map(map, tf, scale, shading);
    const QuantityArguments& given = arguments.quantity;
    if (!given.color_bar && given.title.empty()) return image;
    return annotated(image, tf, scale, {given.title, label, given.color_bar}, shading.background);
}

void set_figures(const RenderArguments& arguments, const std::vector<float>& shown,
                 const ColorScale& scale, RenderedPicture& picture) {
    picture.scale = scale;
    picture.above_range = share_above(shown, scale.high);
    picture.values_output = arguments.quantity.values_output;
    double sum = 0, most = -HUGE_VAL;
    std::size_t count = 0;
    for (const float value : shown) {
        if (std::isnan(value)) continue;
        ++count;
        sum += double{value};
        most = std::max(most, double{value});
    }
    picture.mean_t = count ? sum / static_cast<double>(count) : 0;
    picture.max_t = count ? most : 0;
}

}  // namespace vog::cli
