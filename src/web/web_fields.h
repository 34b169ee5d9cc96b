// web_fields.h: quantised, compressed encoding of a model's fields for the page; page/picture/fields.js decodes it.
//
// A scalar field takes 8 bytes a Gaussian before compression, a vector field 24:
//   value      16 bits a component, linear between the least and the largest
//   gradient   10 bits for each own axis of the ellipsoid: the change over a standard deviation, whose square root
//              is linear
//   deviation  10 bits, whose square root is linear; of vectors that of each component
//   skewness   8 bits from -3 to 3; of vectors in its place the three correlations of the residual, -1 to 1
// Upper 8 bits have columns of their own; the lower 2 share bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "vog/fields.h"
#include "web/web_codec.h"

namespace vog::web {

/// A field's numbers in the page: (value - reference) / unit.
struct WebUnit {
    double reference = 0, unit = 1;
};
/// Of a scalar field the middle of the data's range and half of it; of a vector field 0 and the largest magnitude.
WebUnit web_unit(const ScalarField& field);
WebUnit web_unit(const VectorField& field);

/// A field of one level.
struct WebField {
    struct Value {
        double low = 0, step = 1;  ///< value = low + step * word
    };
    std::vector<Value> value;  ///< [1 or 3 components]
    double change = 1;         ///< largest change over a standard deviation
    double deviation = 1;      ///< largest one
    std::string bytes;         ///< [columns][Gaussians]
};
/// shapes  of the model that has the field
WebField web_field(const WebShapes& shapes, const WebFrame& frame, const ScalarField& field);
WebField web_field(const WebShapes& shapes, const WebFrame& frame, const VectorField& field);

}  // namespace vog::web
