// scene_loader.cpp: Converts files to levels of detail in the background.
#include "session/scene_loader.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>

#include "vog/camera.h"
#include "vog/compare.h"
#include "vog/convert_fields.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/text.h"

namespace vog::viewer {

namespace {

/// A conversion by moments: cells of one size, or the adaptive model with as many Gaussians.
struct Cut {
    int block_voxels;
    bool best;  ///< adaptive
};
// In the order of conversion: quick ones first, for an early picture.
constexpr Cut kCuts[] = {{16, false}, {32, false}, {8, false}, {4, false},
                         {8, true},   {4, true},   {2, false}, {2, true}};
// Cells below the mass threshold are dropped from a budget: this factor makes up for them, so that
// the adaptive level has about as many Gaussians as the uniform one, and follows it in the order.
constexpr double kBudget = 1.05;
constexpr double kMostGaussians = 6e6;  ///< of a level: 270 MB of GPU memory

/// A level of detail with its hierarchy.
/// index_from_world  lattice of the model's cells, if it has cells
Level level_of(const std::string& name, Gaussians model, double share,
               const std::optional<Affine>& index_from_world = {}) {
    Level level;
    level.name = name;
    level.share = share;
    level.hierarchy = std::make_shared<const Hierarchy>(build_hierarchy(model, {index_from_world}));
    level.model = std::make_shared<const Gaussians>(std::move(model));
    return level;
}

std::string title_of(const std::vector<std::string>& files) {
    std::string title = std::filesystem::path(files.front()).filename().string();
    if (files.size() > 1) title += fmt::format(" and {} more", files.size() - 1);
    return title;
}

}  // namespace

SceneLoader::SceneLoader(ReadFiles read) : read_(std::move(read)) {}
SceneLoader::~SceneLoader() { stop(); }

void SceneLoader::stop() {
    {
        const std::lock_guard lock(mutex_);
        cancel_ = true;
    }
    if (thread_.joinable()) thread_.join();
    cancel_ = false;
}

void SceneLoader::open(const std::vector<std::string>& files) {
    stop();
    status_ = {true, "reading " + title_of(files), 0, {}};
    thread_ = std::thread([this, files] {
        try {
            work(files);
        } catch (const Cancelled&) {
        } catch (const std::exception& error) {
            const std::lock_guard lock(mutex_);
            status_.error = error.what();
        }
        const std::lock_guard lock(mutex_);
        status_.busy = false;
    });
}

SceneLoader::Status SceneLoader::status() {
    const std::lock_guard lock(mutex_);
    Status now = status_;
    status_.error.clear();
    return now;
}

bool SceneLoader::take(Scene& scene) {
    const std::lock_guard lock(mutex_);
    if (!changed_) return false;
    scene = scene_;
    changed_ = false;
    return true;
}

void SceneLoader::begin(const std::string& doing) {
    const std::lock_guard lock(mutex_);
    if (cancel_) throw Cancelled{};
    status_.doing = doing;
    status_.fraction = 0;
}

Progress SceneLoader::progress(double from, double to) {
    return [this, from, to](double fraction) {
        const std::lock_guard lock(mutex_);
        if (cancel_) throw Cancelled{};
        status_.fraction = from + (to - from) * fraction;
    };
}

void SceneLoader::add_level(Level level) {
    const std::lock_guard lock(mutex_);
    const auto fewer = [](const Level& a, const Level& b) { return a.size() < b.size(); };
    scene_.levels.insert(std::upper_bound(scene_.levels.begin(), scene_.levels.end(), level, fewer),
                         std::move(level));
    changed_ = true;
}

void SceneLoader::show(Scene scene) {
    const std::lock_guard lock(mutex_);
    scene.opened = scene_.opened + 1;
    scene_ = std::move(scene);
}

void SceneLoader::work(const std::vector<std::string>& files) {
    Content content = read_(files);
    Scene scene;
    scene.title = title_of(files);
    if (content.site) return show_site(*content.site, std::move(scene));
    if (!content.volumes.volumes.empty()) {
        show_volumes(std::move(content.volumes), content.read_fields, std::move(scene));
    } else if (content.points.size() > 0) {
        show_points(content.points, content.point_options, std::move(scene));
    } else {
        if (content.model.size() == 0)
            throw Error(fmt::format("{}: a model without Gaussians", files.front()));
        show_model(std::move(content.model), std::move(content.hierarchy), std::move(scene));
    }
}

void SceneLoader::show_volumes(VolumeSet set, const ReadFields& read_fields, Scene scene) {
    begin("preparing the voxels");
    const auto voxels = std::make_shared<VoxelData>();
    const Overlap overlap = set.overlap;
    const std::size_t count = set.volumes.size();
    const bool mesh = set.is_mesh();
    Composite data;
    if (mesh) {
        data = composite(set);
        voxels->whole.sources.push_back(
            VoxelSource{std::make_shared<const VolumeSet>(std::move(set)), {}});
    } else {
        for (const Volume& volume : set.volumes) {
            data.box.include(world_box(volume));
            data.voxels += active_voxels(volume);
        }
        data.parts = std::move(set.volumes);
        data.content = content_of(data.parts, data.box);
    }
    VoxelSource parts;
    if (read_fields) {
        begin("reading fields");
        for (std::vector<VoxelField>& values : read_fields(data.parts)) {
            const VoxelField& first = values.front();
            parts.fields.push_back({first.name, first.unit, first.is_vector(), {}});
            parts.fields.back().values = std::move(values);
        }
    }
    scene.subject = subject_of(data.box, data.content);
    scene.facts = count_text(data.voxels) + " active voxels";
    if (count > 1) scene.facts += fmt::format(" in {} {}", count, mesh ? "levels" : "volumes");
    auto divided = std::make_shared<VolumeSet>();
    divided->volumes = data.parts;
    parts.volumes = divided;
    if (!mesh) voxels->whole.sources.push_back(VoxelSource{divided, {}});
    voxels->parts.sources.push_back(std::move(parts));
    scene.voxels = voxels;
    show(std::move(scene));
    convert_levels(data, *voxels, overlap);
    data.parts.clear();
    measure_levels();
}

void SceneLoader::show_model(Gaussians model, Hierarchy hierarchy, Scene scene) {
    const std::uint64_t voxels = model.source_voxels;
    scene.subject = subject_of(model);
    scene.facts = voxels ? "a model of " + count_text(voxels) + " active voxels" : "a model";
    show(std::move(scene));
    Level level;
    level.name = model.method.empty() ? "model" : model.method;
    level.made_by = model.options;
    if (voxels) level.share = static_cast<double>(model.size()) / static_cast<double>(voxels);
    if (hierarchy.empty()) {
        begin("finding coarser Gaussians");
        hierarchy = build_hierarchy(model);
    }
    level.hierarchy = std::make_shared<const Hierarchy>(std::move(hierarchy));
    level.model = std::make_shared<const Gaussians>(std::move(model));
    add_level(std::move(level));
}

Level level_of(const SitePath& site) {
    Level level;
    level.site = std::make_shared<SiteCut>(site.folder, site.model);
    const SiteModelInfo& info = level.site->info();
    // The chunk at the root alone: no error is too large.
    const CutOptions coarsest{std::numeric_limits<double>::infinity(), false};
    level.model = std::make_shared<const Gaussians>(
        level.site->choose(frame_of(orbit_view(info.description.box), 1, 1), coarsest));
    level.name = info.description.method.empty() ? "site" : info.description.method;
    level.made_by = info.description.options;
    if (const std::uint64_t voxels = info.description.source_voxels)
        level.share = static_cast<double>(info.gaussians) / static_cast<double>(voxels);
    return level;
}

void SceneLoader::show_site(const SitePath& site, Scene scene) {
    Level level = level_of(site);
    scene.subject = subject_of(level.site->info().description);
    scene.facts =
        fmt::format("a site of {} Gaussians, read as views need them", count_text(level.size()));
    show(std::move(scene));
    add_level(std::move(level));
}

void SceneLoader::show_points(const Points& points, PointOptions options, Scene scene) {
    const auto count = static_cast<double>(points.size());
    scene.unit = "particles";
    scene.facts = count_text(points.size()) + " particles";
    scene.subject = bounds(points);
    options.progress = progress();
    begin("converting: one Gaussian a particle");
    Gaussians all = convert_points(points, options);
    scene.subject = subject_of(all);
    show(std::move(scene));
    add_level(level_of("one a particle", std::move(all), 1));
    for (const double share : {0.0029, 0.019, 0.135}) {
        options.budget = static_cast<std::size_t>(share * count);
        if (options.budget < 64) continue;
        const std::string name = fmt::format("best cut, {} %", 100 * share);
        begin("converting: " + name);
        Gaussians model = convert_points(points, options);
        const double achieved = static_cast<double>(model.size()) / count;
        add_level(level_of(name, std::move(model), achieved));
    }
    measure_levels();
}

/// A part of the volumes, or a whole mesh, with the fields.
Gaussians SceneLoader::converted(const Composite& data, const VoxelData& voxels, std::size_t part,
                                 bool is_mesh, MomentOptions options) {
    std::vector<std::vector<VoxelField>> fields;
    for (const SampledField& field : voxels.parts.voxels().fields) fields.push_back(field.values);
    // The volumes' own values alone come from the conversion itself.
    const auto is_own = [](const std::vector<VoxelField>& field) {
        const VoxelValues& values = field.front().component.front();
        return values.leaf.empty() && values.tile.empty();
    };
    const bool own_alone = fields.size() == 1 && is_own(fields.front());
    if (own_alone) options.own_field = fields.front().front().name;
    if (fields.empty() || own_alone)
        return is_mesh ? convert_moments(data, options)
                       : convert_by_default(data.parts[part], options);
    if (is_mesh) return convert_for_field(data, fields, options, {});
    std::vector<std::vector<VoxelField>> here;
    for (const std::vector<VoxelField>& field : fields) here.push_back({field[part]});
    return convert_for_field(data.parts[part], here, options, {});
}

void SceneLoader::convert_levels(const Composite& data, const VoxelData& voxels_of_data,
                                 Overlap overlap) {
    const bool is_mesh = overlap == Overlap::hide;
    const auto voxels = static_cast<double>(data.voxels);
    std::map<int, double> share_of;  // Gaussians a voxel, of even cuts by their blocks
    for (const Cut& cut : kCuts) {
        if (cut.best && !share_of.count(cut.block_voxels)) continue;
        // Half the edge makes up to eight times as many Gaussians.
        if (cut.block_voxels == 2 && 8 * share_of[4] * voxels > kMostGaussians) continue;
        const double share = cut.best ? kBudget * share_of[cut.block_voxels] : 0;
        if (cut.best && share * voxels < 64) continue;
        const std::string name = cut.best ? fmt::format("best cut, {:.2g} %", 100 * share)
                                          : fmt::format("blocks of {} voxels", cut.block_voxels);
        begin("converting: " + name);

        MomentOptions options;
        if (!cut.best) options.block_voxels = cut.block_voxels;
        Gaussians all;
        const auto parts = static_cast<double>(is_mesh ? 1 : data.parts.size());
        for (std::size_t n = 0; n < data.parts.size(); ++n) {
            const Volume& volume = data.parts[n];
            const auto at = static_cast<double>(n);
            options.progress = progress(at / parts, (at + 1) / parts);
            // Volumes that add up divide a budget by their voxels.
            const double part = is_mesh ? voxels : static_cast<double>(active_voxels(volume));
            if (cut.best)
                options.budget = std::max<std::size_t>(1, static_cast<std::size_t>(share * part));
            append(all, converted(data, voxels_of_data, n, is_mesh, options));
            if (is_mesh) break;
        }
        all.box = data.box;
        all.content = data.content;
        const double achieved = static_cast<double>(all.size()) / voxels;
        if (!cut.best) share_of[cut.block_voxels] = achieved;
        add_level(
            level_of(name, std::move(all), achieved, inverse(data.parts.front().world_from_index)));
    }
}

namespace {

DepthImage depth_of(const vog::Scene& data, const Camera& camera, const Progress& progress = {}) {
    constexpr int kSize = 256;
    PictureRenderer renderer(data);
    return bare_depth(renderer, {.camera = camera, .width = kSize, .height = kSize}, progress);
}

}  // namespace

void SceneLoader::measure_levels() {
    begin("measuring: the truth");
    Scene scene;
    {
        const std::lock_guard lock(mutex_);
        scene = scene_;
    }
    const Camera camera = paper_view(scene.subject.box);
    DepthImage truth = scene.voxels ? depth_of(scene.voxels->whole, camera, progress())
                                    : depth_of(scene_of(scene.levels.back().model), camera);
    set_extinction(truth, auto_extinction(truth));
    for (std::size_t n = 0; n < scene.levels.size(); ++n) {
        begin("measuring: " + scene.levels[n].name);
        const DepthImage image = depth_of(scene_of(scene.levels[n].model), camera);
        const double psnr_db = compare(truth, image).grey.psnr_db;
        const std::lock_guard lock(mutex_);
        scene_.levels[n].psnr_db = psnr_db;
        changed_ = true;
    }
}

}  // namespace vog::viewer
