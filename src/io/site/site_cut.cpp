// site_cut.cpp: cuts through the chunks of a site: which are drawn, which are read, and which are dropped from memory.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "core/parallel.h"
#include "io/site/chunk_file.h"
#include "io/site/manifest.h"
#include "vog/error.h"
#include "vog/site.h"

namespace vog {

using namespace site;

namespace {

/// One camera, and the four sides of its picture as planes, normals inwards: through the eye, or for
/// parallel rays at a distance from it.
class View {
  public:
    View(const CameraFrame& frame, const CutOptions& options) : frame_(frame), options_(options) {
        // Half a pixel wider, as narrow Gaussians are drawn.
        const double side_x = 0.5 * (frame.width + 1) / frame.pixels_per_unit;
        const double side_y = 0.5 * (frame.height + 1) / frame.pixels_per_unit;
        if (frame.orthographic) {
            side_ = {-frame.right, frame.right, -frame.up, frame.up};
            margin_ = {side_x, side_x, side_y, side_y};
        } else {
            side_ = {side_x * frame.forward - frame.right, side_x * frame.forward + frame.right,
                     side_y * frame.forward - frame.up, side_y * frame.forward + frame.up};
            const double corner =
                0.5 * std::hypot(frame.width, frame.height) / frame.pixels_per_unit;
            least_cosine_ = 1 / std::hypot(1, corner);
        }
    }

    bool in_view(const Row& row) const {
        if (!options_.skip_unseen) return true;
        if (farthest(row, frame_.forward) <= 0) return false;
        for (std::size_t n = 0; n < 4; ++n)
            if (farthest(row, side_[n]) + margin_[n] < 0) return false;
        return true;
    }
    /// Largest error of a chunk's nodes, pixels, at the point of its box nearest to the eye; off the middle pixels are longer.
    /// The page's rule: src/web/page/stream/cut.js.
    double pixels(const Row& row) const {
        const double error = double{row.error};
        if (frame_.orthographic) return error * frame_.pixels_per_unit;
        Vec3d to;
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            to[axis] = std::clamp(0.0, double{row.box[k]} - frame_.eye[axis],
                                  double{row.box[k + 3]} - frame_.eye[axis]);
        }
        const double distance = length(to);
        const double cosine =
            distance > 0 ? std::max(dot(frame_.forward, to) / distance, least_cosine_) : 1;
        // Around the eye, too, errors have an order.
        constexpr double kNearest = 1e-3;
        const double at = std::max(distance, kNearest * error);
        return at > 0 ? error * frame_.pixels_per_unit / at / (cosine * cosine) : 0;
    }

  private:
    /// Largest value of dot(x - eye, normal) in a chunk's box.
    double farthest(const Row& row, Vec3d normal) const {
        double sum = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const auto k = static_cast<std::size_t>(axis);
            sum += std::max(normal[axis] * (double{row.box[k]} - frame_.eye[axis]),
                            normal[axis] * (double{row.box[k + 3]} - frame_.eye[axis]));
        }
        return sum;
    }

    CameraFrame frame_;
    CutOptions options_;
    std::array<Vec3d, 4> side_;
    std::array<double, 4> margin_{};
    double least_cosine_ = 1;  ///< of the angle between a corner of the picture and its middle
};

/// A chunk of the tree, as far as it has been read.
struct Node {
    Row row;
    std::vector<Node*> parts{};
    bool has_parts = false;       ///< whether `parts` have been read
    bool ends_here = false;       ///< whether its table cannot be read
    std::uint64_t last_used = 0;  ///< number of the view
    // Shared with the thread that reads.
    std::shared_ptr<Gaussians> chunk{};  ///< null: not in memory
    bool failed = false;                 ///< cannot be read
};

std::uint64_t bytes_of(const Gaussians& chunk) {
    std::uint64_t floats = 7 + (chunk.axis_aligned() ? 0 : 4);
    for (std::size_t k = 0; k < chunk.fields.scalar.size(); ++k) floats += 6;
    for (std::size_t k = 0; k < chunk.fields.vector.size(); ++k) floats += 18;
    return chunk.size() * floats * sizeof(float);
}

/// A chunk to draw.
struct Drawn {
    Node* node;
    std::size_t
        first;  ///< Gaussian: 0, or behind the nodes where parts are drawn in place of these
    std::size_t slot;
    std::size_t count() const { return node->row.gaussians - first; }
    friend bool operator==(const Drawn& a, const Drawn& b) {
        return a.node == b.node && a.first == b.first;
    }
};

enum class Presence { there, absent, failed };

/// A chunk to read, and how large its absence is on the picture.
struct Wanted {
    Node* node;
    double pixels;
};

}  // namespace

struct SiteCut::State {
    std::filesystem::path folder;
    ManifestModel model;
    SiteModelInfo info;
    std::uint64_t memory_bytes = 0;
    std::deque<Node> nodes;
    std::uint64_t view = 0;
    std::vector<Drawn> drawn, before;  ///< before: what `chosen` has
    std::vector<Wanted> wanted;
    Gaussians chosen;
    SiteCutReport report;

    // --- Shared with the thread that reads. ---
    std::mutex mutex;
    std::condition_variable changed;
    std::vector<Wanted> queue;  ///< largest error last
    std::function<void()> arrived;
    bool ending = false;
    std::string fault;  ///< on the first chunk that cannot be read
    std::uint64_t held_bytes = 0, bytes_read = 0;
    std::thread reader;

    ~State();
    Node* add(Row row);
    void open_parts(Node& node);
    std::shared_ptr<Gaussians> read(const Node& node);
    Presence presence(const Node& node);
    void note(const std::string& text);
    void sweep(const View& view, Node& node, double limit, bool wait);
    void load(const std::vector<Node*>& all);
    void gather();
    void drop();
    void run();
    void begin(const CameraFrame& frame, const CutOptions& options, bool wait);
    const Gaussians& finish();
};

SiteCut::State::~State() {
    {
        const std::lock_guard lock(mutex);
        ending = true;
    }
    changed.notify_all();
    if (reader.joinable()) reader.join();
}

Node* SiteCut::State::add(Row row) {
    nodes.push_back({std::move(row)});
    return &nodes.back();
}

/// Makes nodes of a chunk's parts, from its table if need be.
void SiteCut::State::open_parts(Node& node) {
    if (node.has_parts) return;
    std::vector<Row> rows = std::move(node.row.parts);
    if (!node.row.table.empty()) rows = read_parts(folder, node.row, field_count(model));
    for (Row& row : rows) node.parts.push_back(add(std::move(row)));
    node.has_parts = true;
}

std::shared_ptr<Gaussians> SiteCut::State::read(const Node& node) {
    return std::make_shared<Gaussians>(read_chunk(folder, node.row, model));
}

Presence SiteCut::State::presence(const Node& node) {
    const std::lock_guard lock(mutex);
    return node.chunk ? Presence::there : node.failed ? Presence::failed : Presence::absent;
}

void SiteCut::State::note(const std::string& text) {
    const std::lock_guard lock(mutex);
    if (fault.empty()) fault = text;
}

/// Lists what is drawn of a chunk in view and of all below.
/// wait  whether chunks that are not in memory will be read before the picture; else coarser ones stand in
void SiteCut::State::sweep(const View& now, Node& node, double limit, bool wait) {
    node.last_used = view;
    const double pixels = now.pixels(node.row);
    bool refined = node.row.nodes > 0 && pixels > limit && !node.ends_here;
    std::vector<Node*> seen;
    if (refined) {
        try {
            open_parts(node);
        } catch (const Error& error) {
            if (wait) throw;
            note(error.what());
            node.ends_here = true;
            refined = false;
        }
        for (Node* part : node.parts)
            if (now.in_view(part->row)) seen.push_back(part);
    }
    if (refined && !wait)
        for (Node* part : seen) {
            const Presence found = presence(*part);
            if (found == Presence::there) continue;
            refined = false;
            ++report.missing;
            if (found == Presence::absent) wanted.push_back({part, pixels});
        }
    if (!refined || node.row.gaussians > node.row.nodes)
        drawn.push_back({&node, refined ? node.row.nodes : 0u, 0});
    if (!refined) {
        // The parts that have arrived wait for the others.
        for (Node* part : seen) part->last_used = view;
        return;
    }
    for (Node* part : seen) sweep(now, *part, limit, wait);
}

/// Reads chunks in parallel.
void SiteCut::State::load(const std::vector<Node*>& all) {
    std::vector<std::shared_ptr<Gaussians>> chunks(all.size());
    vog::parallel_for(std::size_t{0}, all.size(),
                      [&](std::size_t n) { chunks[n] = read(*all[n]); });
    const std::lock_guard lock(mutex);
    for (std::size_t n = 0; n < all.size(); ++n) {
        if (all[n]->chunk) continue;
        held_bytes += bytes_of(*chunks[n]);
        bytes_read += all[n]->row.all_bytes();
        all[n]->chunk = std::move(chunks[n]);
    }
}

/// Copies what is drawn side by side, unless it is what the last view drew.
void SiteCut::State::gather() {
    if (report.revision > 0 && drawn == before) return;
    before = drawn;
    ++report.revision;
    report.gaussians = 0;
    report.chunks = drawn.size();
    for (Drawn& one : drawn) {
        one.slot = report.gaussians;
        report.gaussians += one.count();
    }
    allocate(chosen, report.gaussians, model.rotated);
    vog::parallel_for(std::size_t{0}, drawn.size(), [&](std::size_t n) {
        const Drawn& one = drawn[n];
        place(*one.node->chunk, one.first, one.node->row.gaussians, chosen, one.slot);
    });
}

/// Drops chunks of the longest ago beyond the limit of memory.
void SiteCut::State::drop() {
    const std::lock_guard lock(mutex);
    if (held_bytes <= memory_bytes) return;
    std::vector<Node*> unused;
    for (Node& node : nodes)
        if (node.chunk && node.last_used != view) unused.push_back(&node);
    std::ranges::sort(unused, {}, &Node::last_used);
    for (Node* node : unused) {
        if (held_bytes <= memory_bytes) return;
        held_bytes -= bytes_of(*node->chunk);
        node->chunk.reset();
    }
}

/// Reads what views want, a few chunks at a time, until the end.
void SiteCut::State::run() {
    constexpr std::size_t kAtOnce = 8;
    std::unique_lock lock(mutex);
    while (true) {
        changed.wait(lock, [&] { return ending || !queue.empty(); });
        if (ending) return;
        std::vector<Node*> batch;
        while (!queue.empty() && batch.size() < kAtOnce) {
            if (!queue.back().node->chunk && !queue.back().node->failed)
                batch.push_back(queue.back().node);
            queue.pop_back();
        }
        lock.unlock();
        for (Node* node : batch) {
            try {
                load({node});
            } catch (const std::exception& error) {
                note(error.what());
                const std::lock_guard again(mutex);
                node->failed = true;
            }
        }
        lock.lock();
        const std::function<void()> tell = arrived;
        lock.unlock();
        if (tell && !batch.empty()) tell();
        lock.lock();
    }
}

const Gaussians& SiteCut::State::finish() {
    report.pending = wanted.size();
    gather();
    drop();
    const std::lock_guard lock(mutex);
    report.held_bytes = held_bytes;
    report.bytes_read = bytes_read;
    return chosen;
}

SiteCut::SiteCut(const std::filesystem::path& folder, std::size_t model, std::uint64_t memory_bytes)
    : state_(std::make_unique<State>()) {
    const Manifest manifest = read_manifest(folder);
    State& s = *state_;
    s.folder = folder;
    s.model = model_at(manifest, model, folder);
    s.info = {s.model.name, s.model.description, s.model.gaussians, s.model.levels};
    s.memory_bytes = memory_bytes;
    s.chosen = s.model.description;
    s.add(s.model.root);
}
SiteCut::~SiteCut() = default;
SiteCut::SiteCut(SiteCut&&) noexcept = default;
SiteCut& SiteCut::operator=(SiteCut&&) noexcept = default;

const SiteModelInfo& SiteCut::info() const { return state_->info; }
const SiteCutReport& SiteCut::report() const { return state_->report; }
std::string SiteCut::fault() const {
    const std::lock_guard lock(state_->mutex);
    return state_->fault;
}

/// Begins a view.
/// wait  as of sweep
void SiteCut::State::begin(const CameraFrame& frame, const CutOptions& options, bool wait) {
    if (!(options.pixel_error >= 0))
        throw Error(fmt::format("pixel error {}, expected a number >= 0", options.pixel_error));
    ++view;
    drawn.clear(), wanted.clear();
    report.missing = 0;
    Node& root = nodes.front();
    if (!wait && presence(root) != Presence::there) load({&root});
    const View now(relative_to(frame, model.description.origin), options);
    if (now.in_view(root.row)) sweep(now, root, options.pixel_error, wait);
}

const Gaussians& SiteCut::choose(const CameraFrame& frame, const CutOptions& options) {
    State& s = *state_;
    s.begin(frame, options, true);
    std::vector<Node*> missing;
    for (const Drawn& one : s.drawn)
        if (s.presence(*one.node) != Presence::there) missing.push_back(one.node);
    s.load(missing);
    return s.finish();
}

const Gaussians& SiteCut::choose_available(const CameraFrame& frame, const CutOptions& options,
                                           const std::function<void()>& arrived) {
    State& s = *state_;
    s.begin(frame, options, false);
    std::ranges::sort(s.wanted, {}, &Wanted::pixels);
    {
        const std::lock_guard lock(s.mutex);
        s.queue = s.wanted;
        s.arrived = arrived;
        if (!s.reader.joinable() && !s.queue.empty()) s.reader = std::thread([&s] { s.run(); });
    }
    s.changed.notify_all();
    return s.finish();
}

}  // namespace vog
