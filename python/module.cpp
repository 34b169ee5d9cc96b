// module.cpp: the module vog._vog: errors, signals, threads, and the bindings in the order of the
// data.
#include <cstdio>
#include <vector>

#include "bindings.h"
#include "vog/error.h"
#include "vog/memory.h"

namespace vog::python {

namespace {

/// Identifier of threading.main_thread(); 0 until the module is imported.
unsigned long main_thread = 0;

/// Context manager of `with vog.threads(2):`.
struct Threads {
    explicit Threads(int threads) : count(threads) {
        if (count < 0) throw Error("threads: " + std::to_string(count) + ", expected 0 or more");
    }
    int count = 0;
    std::optional<ThreadLimit> limit{};
};

/// Context manager of `with vog.memory_limit(2e9):`.
struct Memory {
    Memory(double bytes, std::string folder) : most(bytes), place(std::move(folder)) {
        if (!(most >= 1 && most <= 1e18))
            throw Error("memory_limit: " + short_text(most) +
                        " bytes, expected at least 64 MiB: 2e9, say");
    }
    double most = 0;
    std::string place;
    std::optional<MemoryLimit> limit{};
};

void bind_memory(py::module_& m) {
    m.def("peak_memory", &peak_memory, "Peak resident memory of the process so far, bytes.");
    py::class_<Memory>(
        m, "memory_limit",
        R"(Context manager that limits the memory in which voxels lie, in the whole process:

    with vog.memory_limit(2e9):
        model = vog.convert(vog.load("wide.zarr"))

bytes   at least 64 MiB. Arrays of voxels of a sixteenth of it and more that are made meanwhile lie in files, whose pages are dropped
        when the process comes near the limit. Results are the same bytes
folder  of the files, on a disk with room for the uncompressed voxels; '': the system's temporary folder

Models, cells and pictures are not limited. Linux only. Raises vog.Error for too small a limit, inside another limit, and for a folder that cannot be
written or lies in memory.

>>> with vog.memory_limit(1e9):
...     len(vog.convert(vog.sample_cloud(64), budget=100)) <= 100
True)")
        .def(py::init<double, std::string>(), py::arg("bytes"), py::arg("folder") = "")
        .def("__enter__",
             [](Memory& self) -> Memory& {
                 self.limit.emplace(static_cast<std::uint64_t>(self.most), self.place);
                 return self;
             })
        .def("__exit__", [](Memory& self, const py::args&) { self.limit.reset(); });
}

void bind_threads(py::module_& m) {
    m.def("thread_count", &thread_count, "Number of threads that vog's parallel loops use now.");
    py::class_<Threads>(
        m, "threads",
        R"(Context manager that limits the threads of vog's parallel loops, in the whole process:

    with vog.threads(2):
        model = vog.convert(volume)

count  number of threads; 0: one per core

Results are the same bytes for any number. Raises vog.Error for a negative count.

>>> with vog.threads(1):
...     vog.thread_count()
1)")
        .def(py::init<int>(), py::arg("count"))
        .def("__enter__",
             [](Threads& self) -> Threads& {
                 self.limit.emplace(self.count);
                 return self;
             })
        .def("__exit__", [](Threads& self, const py::args&) { self.limit.reset(); });
}

}  // namespace

bool on_main_thread() { return PyThread_get_thread_ident() == main_thread; }

void run_signal_handlers() {
    const py::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
}

Progress progress_of(const py::object& callable) {
    if (callable.is_none()) return {};
    if (!PyCallable_Check(callable.ptr()))
        throw py::type_error("progress: expected a callable that takes the finished fraction");
    // A borrowed reference, as copies of the function are made and destroyed without the lock.
    return [function = py::handle(callable)](double fraction) {
        const py::gil_scoped_acquire acquire;
        function(fraction);
    };
}

std::string described(const py::handle& object) {
    const py::object text = py::module_::import("vog._packages").attr("described")(object);
    return text.cast<std::string>();
}

void warn(const std::vector<std::string>& texts) {
    if (texts.empty()) return;
    const py::object spoken = py::module_::import("vog._messages").attr("spoken");
    for (const std::string& text : texts)
        if (PyErr_WarnEx(PyExc_UserWarning, spoken(text).cast<std::string>().c_str(), 1) != 0)
            throw py::error_already_set();
}

std::string short_text(double number) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", number);
    return text;
}

std::pair<int, int> size_of(const py::object& size) {
    const auto edge = [&](const py::handle& number) {
        try {
            return py::int_(py::module_::import("operator").attr("index")(number)).cast<int>();
        } catch (const py::error_already_set&) {
        } catch (const py::cast_error&) {
        }
        throw Error("size: " + described(size) +
                    ", expected pixels: 512 or (640, 480), width first");
    };
    if (!PySequence_Check(size.ptr())) return {edge(size), edge(size)};
    if (py::len(size) != 2) return {edge(size), 0};  // edge() throws for a sequence
    return {edge(size[py::int_(0)]), edge(size[py::int_(1)])};
}

std::optional<double> extinction_of(const py::object& extinction) {
    if (py::isinstance<py::str>(extinction) && extinction.cast<std::string>() == "auto") return {};
    const double value = PyFloat_AsDouble(extinction.ptr());
    if (!PyErr_Occurred()) return value;
    PyErr_Clear();
    throw Error("extinction: " + described(extinction) + ", expected a number > 0 or 'auto'");
}

}  // namespace vog::python

PYBIND11_MODULE(_vog, m) {
    using namespace vog::python;
    // Classes appear as vog.X, not vog._vog.X, in messages, help() and pickles.
    m.attr("__name__") = "vog";
    m.attr("__version__") = VOG_VERSION;
    main_thread =
        py::module_::import("threading").attr("main_thread")().attr("ident").cast<unsigned long>();
    py::register_exception<vog::Error>(m, "Error").attr("__doc__") =
        "Error in an input, file, option or device. One line: subject, problem, got, expected.";
    bind_threads(m);
    bind_memory(m);
    bind_camera(m);
    bind_shade(m);
    bind_image(m);
    bind_volume(m);
    bind_points(m);
    bind_cells(m);
    bind_fields(m);
    bind_gaussians(m);
    bind_sample(m);
    bind_convert(m);
    bind_picture(m);
    bind_compare(m);
    bind_exchange(m);
    bind_voxelize(m);
    bind_evaluate(m);
    bind_web(m);
    m.attr("__name__") = "vog._vog";
    py::list names;
    for (const auto& [name, object] : m.attr("__dict__").cast<py::dict>())
        if (name.cast<std::string>().front() != '_') names.append(name);
    m.attr("__all__") = names;
}
