// bind_fields.cpp: Field: one field of a model, its arrays as views.
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>

#include "arrays.h"
#include "fields.h"
#include "vog/error.h"

namespace vog::python {

namespace {

/// A field by its model, which it keeps alive, and its name.
struct Field {
    py::object model;
    std::string name;

    /// The field, or null if it is of the other kind.
    template <class Kind>
    Kind* in(std::vector<Kind>& fields) const {
        const auto found = std::ranges::find(fields, name, &Kind::name);
        return found == fields.end() ? nullptr : &*found;
    }
    ScalarField* scalar() const { return in(model.cast<Gaussians&>().fields.scalar); }
    VectorField* vector() const { return in(model.cast<Gaussians&>().fields.vector); }
    /// throws AttributeError for a vector field
    ScalarField& require_scalar(const char* attribute, const char* instead) const {
        if (ScalarField* field = scalar()) return *field;
        throw py::attribute_error("vog.Field: " + name + " is a vector field without " + attribute +
                                  ", expected " + instead);
    }
};

/// Calls use(field) with the ScalarField or the VectorField.
template <class Use>
auto with(const Field& self, const Use& use) {
    if (ScalarField* field = self.scalar()) return use(*field);
    return use(*self.vector());
}

/// Read-only array [N, 3, 3] of value(i, row, column).
template <class Value>
py::array matrices(std::size_t size, const Value& value) {
    py::array_t<float> all({static_cast<py::ssize_t>(size), py::ssize_t{3}, py::ssize_t{3}});
    auto at = all.mutable_unchecked<3>();
    for (std::size_t i = 0; i < size; ++i)
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) at(static_cast<py::ssize_t>(i), r, c) = value(i, r, c);
    all.attr("setflags")(py::arg("write") = false);  // a copy: what is written there is lost
    return all;
}

/// Place of element r, c in xx xy xz yy yz zz.
std::size_t packed(int r, int c) {
    constexpr std::array<std::array<std::size_t, 3>, 3> kPlace{{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}};
    return kPlace[static_cast<std::size_t>(r)][static_cast<std::size_t>(c)];
}

py::array value_of(const Field& self) {
    return with(self, [&](auto& field) { return view_of<float>(field.value, self.model); });
}

py::array gradient_of(const Field& self) {
    if (ScalarField* field = self.scalar()) return view_of<float>(field->gradient, self.model);
    const VectorField& field = *self.vector();
    return matrices(field.value.size(), [&](std::size_t i, int component, int axis) {
        return field.gradient[static_cast<std::size_t>(component)][i][axis];
    });
}

py::array covariance_of(const Field& self) {
    const VectorField* field = self.vector();
    if (!field)
        throw py::attribute_error("vog.Field: " + self.name +
                                  " is a scalar field without covariance, expected deviation");
    return matrices(field->value.size(), [&](std::size_t i, int r, int c) {
        return field->covariance[i][packed(r, c)];
    });
}

/// Attributes of a field as the user gives them, by name; None where there is none.
class Given {
  public:
    Given(std::string name, const py::object& field) : name_(std::move(name)) {
        const std::initializer_list<const char*> known{
            "value", "gradient", "deviation", "skewness", "covariance", "unit", "range", "spread"};
        if (!py::isinstance<py::dict>(field) && !py::isinstance<Field>(field))
            throw Error("fields: " + name_ +
                        ": expected a dict of value, gradient, ..., or a vog.Field");
        for (const char* key : known)
            if (py::isinstance<Field>(field))
                given_[key] = py::getattr(field, key, py::none());
            else if (field.contains(key))
                given_[key] = field[py::str(key)];
        if (!py::isinstance<py::dict>(field)) return;
        for (const auto& [key, _] : py::cast<py::dict>(field))
            if (!given_.contains(key))
                throw Error("fields: " + name_ + ": unknown " + py::repr(key).cast<std::string>() +
                            ", expected value, gradient, deviation, skewness, covariance, unit, "
                            "range or spread");
    }
    bool has(const char* key) const { return given_.contains(key) && !given_[key].is_none(); }
    py::object at(const char* key) const { return given_[key]; }
    std::string label(const char* key) const { return "fields: " + name_ + ": " + key; }
    const std::string& name() const { return name_; }

    /// [N] or [N, 3] as items; zeros if it is not given.
    template <class Item>
    BigVector<Item> items(const char* key, std::size_t size) const {
        if (!has(key)) return BigVector<Item>(size);
        if constexpr (sizeof(Item) == sizeof(float)) {
            const py::array_t<float> row = row_of<float>(at(key), label(key));
            return {row.data(), row.data() + row.size()};
        } else {
            return vector_of<Item, float>(at(key), label(key));
        }
    }
    /// [N, 3, 3] as rows of N matrices; an empty array if it is not given.
    py::array_t<float> matrices(const char* key, std::size_t size) const {
        if (!has(key)) return {};
        const py::array array = numbers_of(at(key), label(key));
        if (array.ndim() != 3 || array.shape(0) != static_cast<py::ssize_t>(size) ||
            array.shape(1) != 3 || array.shape(2) != 3)
            throw Error(label(key) + ": shape " + shape_text(array) + ", expected (" +
                        std::to_string(size) + ", 3, 3)");
        return py::array_t<float, py::array::c_style | py::array::forcecast>(array);
    }

  private:
    std::string name_;
    py::dict given_;
};

/// Sets unit and range.
/// magnitude  of each Gaussian's value, for a range that is not given
template <class Kind, class Magnitude>
void describe(Kind& field, const Given& given, const Magnitude& magnitude) {
    field.name = given.name();
    if (given.has("unit"))
        field.unit = cast_to<std::string>(given.at("unit"), given.label("unit"), "a text");
    if (given.has("range")) {
        const auto range = row_of<double>(given.at("range"), given.label("range"));
        if (range.size() != 2)
            throw Error(given.label("range") + ": " + std::to_string(range.size()) +
                        " numbers, expected 2");
        field.lower = range.at(0);
        field.upper = range.at(1);
        return;
    }
    bool is_first = true;
    for (const auto& value : field.value) {
        const double m = magnitude(value);
        if (!std::isfinite(m)) continue;  // validate() names the Gaussian
        field.lower = is_first ? m : std::min(field.lower, m);
        field.upper = is_first ? m : std::max(field.upper, m);
        is_first = false;
    }
}

ScalarField scalar_from(const Given& given, std::size_t size) {
    if (given.has("covariance"))
        throw Error(given.label("covariance") + ": of a scalar field, expected deviation");
    ScalarField field;
    field.value = given.items<float>("value", size);
    field.gradient = given.items<Vec3f>("gradient", size);
    field.deviation = given.items<float>("deviation", size);
    field.skewness = given.items<float>("skewness", size);
    describe(field, given, [](float value) { return double{value}; });
    if (given.has("spread")) {
        const auto spread = row_of<double>(given.at("spread"), given.label("spread"));
        if (spread.size() != 3)
            throw Error(given.label("spread") + ": " + std::to_string(spread.size()) +
                        " numbers, expected 3");
        field.spread = {spread.at(0), spread.at(1), spread.at(2), true};
    }
    return field;
}

VectorField vector_from(const Given& given, std::size_t size) {
    for (const char* key : {"deviation", "skewness"})
        if (given.has(key))
            throw Error(given.label(key) + ": of a vector field, expected covariance");
    VectorField field;
    field.value = given.items<Vec3f>("value", size);
    const py::array_t<float> gradient = given.matrices("gradient", size);
    const py::array_t<float> covariance = given.matrices("covariance", size);
    for (BigVector<Vec3f>& component : field.gradient) component.resize(size);
    field.covariance.resize(size);
    for (std::size_t i = 0; i < size; ++i)
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) {
                const auto n = static_cast<py::ssize_t>(i);
                if (gradient.size())
                    field.gradient[static_cast<std::size_t>(r)][i][c] = gradient.at(n, r, c);
                if (covariance.size() && r <= c)
                    field.covariance[i][packed(r, c)] = covariance.at(n, r, c);
            }
    describe(field, given, [](Vec3f value) { return double{length(value)}; });
    return field;
}

}  // namespace

py::object fields_of(const py::object& model) {
    py::dict all;
    for (const std::string& name : model.cast<const Gaussians&>().fields.names())
        all[py::str(name)] = py::cast(Field{model, name});
    return py::module_::import("types").attr("MappingProxyType")(all);
}

Fields fields_from(const py::object& fields, std::size_t size) {
    Fields all;
    if (fields.is_none()) return all;
    if (!py::hasattr(fields, "keys"))
        throw py::type_error("fields: got " + described(fields) + ", expected {name: field}");
    for (const auto& [name, field] : py::dict(fields)) {
        const Given given(cast_to<std::string>(name, "fields", "names"),
                          py::reinterpret_borrow<py::object>(field));
        if (!given.has("value")) throw Error(given.label("value") + ": missing");
        if (numbers_of(given.at("value"), given.label("value")).ndim() == 1)
            all.scalar.push_back(scalar_from(given, size));
        else
            all.vector.push_back(vector_from(given, size));
    }
    return all;
}

py::dict plain_fields(const py::object& model) {
    py::dict all;
    for (const auto& [name, object] : py::dict(fields_of(model))) {
        const auto& field = object.cast<const Field&>();
        py::dict plain;
        plain["value"] = object.attr("value");
        plain["gradient"] = object.attr("gradient");
        std::vector<const char*> rest{"covariance"};
        if (field.scalar()) rest = {"deviation", "skewness", "spread"};
        for (const char* key : rest) plain[key] = object.attr(key);
        plain["unit"] = object.attr("unit");
        plain["range"] = object.attr("range");
        all[name] = plain;
    }
    return all;
}

void bind_fields(py::module_& m) {
    py::class_<Field> c(
        m, "Field",
        R"(A quantity that a model's Gaussians know beside their density: model.fields["temperature"].

Inside Gaussian i a scalar field is the plane value[i] + gradient[i] . (x - world_mean[i]), plus a
residual of standard deviation deviation[i] and skewness skewness[i]; a vector field is three of
them, whose residuals have the covariance covariance[i]. Arrays are views of the model's memory, but
for gradient and covariance of a vector field, which are read-only copies.)");
    c.def_readonly("name", &Field::name, "Name: 'temperature'.")
        .def_property_readonly(
            "is_vector", [](const Field& self) { return self.vector() != nullptr; },
            "Whether it is a vector field, of components along the world's axes.")
        .def_property_readonly(
            "is_measure",
            [](const Field& self) { return self.scalar() != nullptr && self.scalar()->is_measure; },
            "Whether it is the density itself: the values of the volume that was converted.")
        .def_property_readonly(
            "background",
            [](const Field& self) { return self.scalar() ? self.scalar()->background : 0.0; },
            "Of the density itself: the value at which the density is 0.")
        .def_property_readonly(
            "unit", [](const Field& self) { return with(self, [](auto& f) { return f.unit; }); },
            "Unit: 'K'; empty if it is not known.")
        .def_property_readonly(
            "range",
            [](const Field& self) {
                return with(self, [](auto& f) { return py::make_tuple(f.lower, f.upper); });
            },
            "(least, largest) value of the data, of a vector field by magnitude.")
        .def_property_readonly(
            "spread",
            [](const Field& self) -> py::object {
                if (!self.scalar() || !self.scalar()->spread.known) return py::none();
                const ValueSpread& s = self.scalar()->spread;
                return py::make_tuple(s.low, s.middle, s.high);
            },
            "1st, 50th and 99th percentile of a scalar field over the data, by mass; None: not "
            "known.")
        .def_property(
            "value", &value_of,
            [](const Field& self, const py::object& data) {
                with(self, [&](auto& field) { assign<float>(field.value, data, "value"); });
            },
            "[N] float32 view: values at the means; of a vector field [N, 3].")
        .def_property(
            "gradient", &gradient_of,
            [](const Field& self, const py::object& data) {
                assign<float>(self.require_scalar("settable gradient", "a new model").gradient,
                              data, "gradient");
            },
            "[N, 3] float32 view: gradients, unit per world unit; of a vector field [N, 3, 3], "
            "component by axis.")
        .def_property(
            "deviation",
            [](const Field& self) {
                return view_of<float>(self.require_scalar("deviation", "covariance").deviation,
                                      self.model);
            },
            [](const Field& self, const py::object& data) {
                assign<float>(self.require_scalar("deviation", "covariance").deviation, data,
                              "deviation");
            },
            "[N] float32 view: standard deviations of the residuals, >= 0; scalar fields.")
        .def_property(
            "skewness",
            [](const Field& self) {
                return view_of<float>(self.require_scalar("skewness", "covariance").skewness,
                                      self.model);
            },
            [](const Field& self, const py::object& data) {
                assign<float>(self.require_scalar("skewness", "covariance").skewness, data,
                              "skewness");
            },
            "[N] float32 view: skewness of the residuals, [-3, 3]; scalar fields.")
        .def_property_readonly(
            "covariance", &covariance_of,
            "[N, 3, 3] float32: covariance of the residuals, unit squared; vector fields.")
        .def("__repr__", [](const Field& self) {
            return with(self, [&](auto& f) {
                return "<vog.Field: " + f.name + (f.unit.empty() ? "" : " in " + f.unit) +
                       (self.vector() ? ", vectors>" : ">");
            });
        });
}

}  // namespace vog::python
