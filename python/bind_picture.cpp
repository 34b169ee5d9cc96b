// bind_picture.cpp: pictures of requests: the scene that is drawn, and Picture, its numbers and colours.
#include <memory>
#include <mutex>
#include <optional>

#include "arrays.h"
#include "data.h"
#include "picture_data.h"
#include "vog/cells.h"
#include "vog/error.h"
#include "vog/picture_record.h"
#include "vog/request_schema.h"

namespace vog::python {

namespace {

/// A finished picture with what recolours it.
struct DrawnPicture {
    Picture picture;
    Scene scene;  ///< without its sources: name, units and what views frame
};

/// Data, prepared for pictures of one kind.
class PictureScene {
  public:
    /// data, fields  of each input: several are for layers
    PictureScene(std::vector<py::object> data, std::vector<py::object> fields)
        : data_(std::move(data)), fields_(std::move(fields)) {
        for (std::size_t n = 0; n < data_.size(); ++n) require_drawable(data_[n], fields_.at(n));
    }

    DrawnPicture draw(const std::string& json, const py::object& progress) try {
        PictureRequest request = request_of_json(json);
        require_effects(request);
        const Progress report = progress_of(progress);
        // Waits without the interpreter's lock, which a picture that is drawn may need for its progress.
        std::unique_lock lock(drawing_, std::defer_lock);
        unlocked([&] { lock.lock(); });
        prepare(request);
        return unlocked([&] {
            const ResolvedPicture picture = resolve(request, renderer_->scene());
            require_effects(picture.request);
            Sums sums;
            renderer_->draw(picture, sums, report);
            Scene frame = renderer_->scene();
            frame.sources.clear(), frame.layers.clear();
            Picture finished = finish(std::move(sums), picture, frame);
            return DrawnPicture{std::move(finished), std::move(frame)};
        });
    } catch (const Error& error) {
        const std::string text = error.what();
        throw Error(text.starts_with("render: ") ? text : "render: " + text);
    }

  private:
    /// Makes the scenes of layers and their renderer, unless they are there.
    void prepare_layers(PictureRequest& request) {
        std::string kind = "layers";
        for (const Layer& layer : request.layers) {
            if (layer.input >= data_.size())
                throw Error("layers: one draws input " + std::to_string(layer.input) +
                            ", counted from 0, but " + std::to_string(data_.size()) +
                            " given, expected all inputs of the picture");
            kind += layer.visible ? " " + std::to_string(layer.input) + layer.field : " -";
        }
        if (kind != kind_) {
            kind_.clear(), layer_fields_.clear();
            std::vector<Scene> scenes;
            for (const Layer& layer : request.layers) {
                PictureRequest one = request;
                one.layers.clear();
                one.field = layer.field;
                scenes.push_back(layer.visible
                                     ? scene_of_data(data_[layer.input], fields_[layer.input], one)
                                     : Scene{});
                layer_fields_.push_back(one.field);
            }
            renderer_ = std::make_unique<PictureRenderer>(scene_of_layers(std::move(scenes)));
            kind_ = kind;
        }
        for (std::size_t n = 0; n < request.layers.size(); ++n)
            request.layers[n].field = layer_fields_[n];
    }

    /// Makes the scene and the renderer that a request needs, unless they are there.
    void prepare(PictureRequest& request) {
        if (!request.layers.empty()) return prepare_layers(request);
        if (surface_of(data_.front()))
            throw Error("a surface, expected Layers: of it, and of a volume or Gaussians");
        const Show show = request.show;
        std::string kind = is_by_value(show)      ? "values of " + request.field
                           : shows_field(request) ? "map of " + request.field
                                                  : "T";
        if (request.options.pixel_error) kind += ", cut";
        if (py::isinstance<Cells>(data_.front())) kind = "cells";
        if (kind != kind_) {
            kind_.clear();
            renderer_ = std::make_unique<PictureRenderer>(
                scene_of_data(data_.front(), fields_.front(), request));
            field_ = request.field;
            kind_ = kind;
        }
        if (kind != "cells") request.field = field_;
    }

    std::vector<py::object> data_, fields_;
    std::string kind_, field_;
    std::vector<std::string> layer_fields_;
    std::unique_ptr<PictureRenderer> renderer_;
    std::mutex drawing_{};  ///< scene and buffers are for one picture at a time
};

std::string record_of(const DrawnPicture& drawn) {
    PictureRecord record{drawn.picture.made.request, {}};
    record.version = VOG_VERSION;
    return record_json(record);
}

/// The picture with other colours and marks; of the same numbers.
DrawnPicture recolored(const DrawnPicture& drawn, const std::string& json) try {
    const Picture& from = drawn.picture;
    const PictureRequest request = request_of_json(json, from.made.request);
    require_effects(request);
    return unlocked([&] {
        Sums sums = from.sums;
        if (request.show == Show::depth)
            for (float& t : sums.column) t = static_cast<float>(double{t} / from.extinction);
        return DrawnPicture{finish(std::move(sums), recolored(from.made, request), drawn.scene),
                            drawn.scene};
    });
} catch (const Error& error) {
    throw Error(std::string("recolor: ") + error.what());
}

/// View [height, width] of numbers in the picture.
py::object plane(const py::object& self, std::span<const float> values) {
    if (values.empty()) return py::none();
    const Sums& sums = self.cast<const DrawnPicture&>().picture.sums;
    py::array_t<float> view({sums.height, sums.width}, values.data(), self);
    view.attr("flags").attr("writeable") = false;
    return view;
}
template <std::vector<float> Sums::*kPlane>
py::object plane_of(const py::object& self) {
    return plane(self, self.cast<const DrawnPicture&>().picture.sums.*kPlane);
}

void save_values(const DrawnPicture& self, const std::filesystem::path& file) {
    unlocked([&] { write_numbers(file, self.picture, record_of(self)); });
}

py::object scale_of(const DrawnPicture& self) {
    using Kind = ColorScale::Kind;
    const ColorScale& scale = self.picture.scale;
    if (scale.kind == Kind::visibility) return py::none();
    return py::make_tuple(scale.low, scale.high, scale.kind == Kind::log ? "log" : "linear");
}

/// "column density", "temperature [K]": name and unit of the numbers.
std::string label_of(const DrawnPicture& self) {
    const ResolvedPicture& made = self.picture.made;
    return with_unit(made.name, made.unit);
}

/// Transfer function of a name, a file or an object as JSON.
std::string transfer_json(const py::object& tf) {
    PictureRequest request;
    if (py::isinstance<py::str>(tf) || py::hasattr(tf, "__fspath__"))
        request.transfer.points =
            transfer_points(cast_to<std::filesystem::path>(tf, "tf", "a path").string());
    else
        request.transfer.points = transfer_points(transfer_function_of(tf));
    return request_json(request);
}

/// Numbers, colours and request of a picture, for pickles.
py::tuple state_of_picture(const py::object& self) {
    const Picture& p = self.cast<const DrawnPicture&>().picture;
    const ColorScale& scale = p.scale;
    return py::make_tuple(
        request_json(p.made.request), p.made.name, p.made.unit, p.sums.width, p.sums.height,
        self.attr("column"), self.attr("mean"), self.attr("deviation"), plane(self, p.sums.maximum),
        plane(self, p.sums.slice), plane(self, p.opacity), py::cast(Bitmap(p.image)).attr("rgba"),
        static_cast<int>(scale.kind), scale.low, scale.high, p.extinction);
}
DrawnPicture picture_of(const py::tuple& state) {
    DrawnPicture drawn;
    Picture& p = drawn.picture;
    p.made.request = request_of_json(state[0].cast<std::string>());
    p.made.name = state[1].cast<std::string>(), p.made.unit = state[2].cast<std::string>();
    p.sums.width = state[3].cast<int>(), p.sums.height = state[4].cast<int>();
    std::size_t at = 5;
    for (std::vector<float>* values : {&p.sums.column, &p.sums.mean, &p.sums.deviation,
                                       &p.sums.maximum, &p.sums.slice, &p.opacity}) {
        const py::object given = state[at++];
        if (given.is_none()) continue;
        const py::array_t<float, py::array::c_style | py::array::forcecast> array(given);
        values->assign(array.data(), array.data() + array.size());
    }
    const py::array_t<float, py::array::c_style | py::array::forcecast> rgba(state[at++]);
    p.image = Image(static_cast<int>(rgba.shape(1)), static_cast<int>(rgba.shape(0)));
    std::copy_n(rgba.data(), rgba.size(), &p.image.pixel.front().r);
    p.scale = {static_cast<ColorScale::Kind>(state[at].cast<int>()), state[at + 1].cast<double>(),
               state[at + 2].cast<double>()};
    p.extinction = state[at + 3].cast<double>();
    return drawn;
}

void bind_picture_class(py::module_& m) {
    py::class_<DrawnPicture>(
        m, "Picture", py::buffer_protocol(),
        R"(A picture as render() returns it: its numbers, their colours, and how it was made.

np.asarray(picture) is a view of `values`, [height, width] float32, rows from the top; `image` has the colours.
Notebooks display it. PNG and EXR files keep the request: `vog render --request picture.png` draws it again.)")
        .def_buffer([](DrawnPicture& self) {
            const Sums& sums = self.picture.sums;
            const auto width = static_cast<std::size_t>(sums.width);
            return py::buffer_info(const_cast<float*>(self.picture.values().data()),
                                   {static_cast<std::size_t>(sums.height), width},
                                   {sizeof(float) * width, sizeof(float)}, true);
        })
        .def_property_readonly(
            "values",
            [](const py::object& self) {
                return plane(self, self.cast<const DrawnPicture&>().picture.values());
            },
            "[height, width] float32: the shown numbers, NaN where nothing is. Of T at the "
            "extinction, of volume the opacity.")
        .def_property_readonly(
            "column", &plane_of<&Sums::column>,
            "[height, width] float32: integral of the density along the ray, of show 'T' times the "
            "extinction, of 'slice' the density; None where it was not drawn.")
        .def_property_readonly("mean", &plane_of<&Sums::mean>,
                               "[height, width] float32: mean of the field along the ray, weighted "
                               "by density; None where it was not drawn.")
        .def_property_readonly("deviation", &plane_of<&Sums::deviation>,
                               "[height, width] float32: standard deviation of the field along the "
                               "ray, weighted by density; None where it was not drawn.")
        .def_property_readonly(
            "image", [](const DrawnPicture& self) { return Bitmap(self.picture.image); },
            "The colours, a vog.Image, with the marks around it.")
        .def_property_readonly(
            "depth",
            [](const DrawnPicture& self) {
                if (self.picture.sums.column.empty() || !is_depth(self.picture.made.request.show))
                    throw Error("depth: of show 'T' and 'column'");
                return std::make_shared<DepthImage>(self.picture.depth());
            },
            "The DepthImage of show 'T' or 'column': optical depth that takes another extinction.")
        .def_property_readonly("_scale", &scale_of)
        .def_property_readonly("label", &label_of,
                               "Name and unit of the numbers: 'temperature [K]'.")
        .def_property_readonly(
            "unit", [](const DrawnPicture& self) { return self.picture.made.unit; },
            "Unit of the numbers: 'K'; empty: not known.")
        .def_property_readonly(
            "extinction", [](const DrawnPicture& self) { return self.picture.extinction; },
            "Factor on density in T.")
        .def_property_readonly(
            "camera", [](const DrawnPicture& self) { return self.picture.made.camera(); },
            "The view, a vog.Camera.")
        .def_property_readonly(
            "_request",
            [](const DrawnPicture& self) { return request_json(self.picture.made.request); })
        .def_property_readonly(
            "shape",
            [](const DrawnPicture& self) {
                return py::make_tuple(self.picture.sums.height, self.picture.sums.width);
            },
            "(height, width) in pixels, without the marks around the picture.")
        .def("_recolored", &recolored)
        .def(
            "save",
            [](const DrawnPicture& self, const std::filesystem::path& file) {
                if (file.extension() == ".npy") return save_values(self, file);
                unlocked([&] { write_image(file, self.picture.image, record_of(self)); });
            },
            py::arg("file"),
            "Writes the image as .png or .exr with the request, or the values as .npy.")
        .def("save_values", &save_values, py::arg("file"),
             "Writes the values: .npy, or .exr with a channel Y (T and column), 'maximum', "
             "'opacity' (of volume), or all of column, mean and deviation.")
        .def("_repr_png_",
             [](const DrawnPicture& self) {
                 return py::cast(Bitmap(self.picture.image)).attr("_repr_png_")();
             })
        .def(py::pickle(&state_of_picture, &picture_of))
        .def("__repr__", [](const DrawnPicture& self) {
            return "<vog.Picture: " + label_of(self) + ", " +
                   std::to_string(self.picture.sums.width) + "x" +
                   std::to_string(self.picture.sums.height) + ">";
        });
}

}  // namespace

void bind_picture(py::module_& m) {
    bind_picture_class(m);
    py::class_<PictureScene, std::shared_ptr<PictureScene>>(m, "_Scene")
        .def(py::init<std::vector<py::object>, std::vector<py::object>>())
        .def("draw", &PictureScene::draw);
    m.def("_transfer_json", &transfer_json);
    m.def("_request_schema", [] {
        py::dict all;
        for (const RequestMember& one : request_schema())
            all[py::str(one.key)] = py::make_tuple(one.takes, one.text, one.unset, one.choices,
                                                   one.shows, one.renderers);
        return all;
    });
}

}  // namespace vog::python
