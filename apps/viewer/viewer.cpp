// viewer.cpp: main loop: events, session, picture, panels.
#include "viewer.h"

#include <fmt/core.h>
#include <imgui.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <utility>

#include "gl/gui_gl.h"
#include "script/script_player.h"
#include "ui/panels.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

using Clock = std::chrono::steady_clock;
double ms_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

/// Dear ImGui's context, without its files.
class GuiContext {
  public:
    GuiContext() {
        ImGui::CreateContext();
        ImGui::GetIO().IniFilename = nullptr;
        ImGui::GetIO().LogFilename = nullptr;
    }
    ~GuiContext() { ImGui::DestroyContext(); }
    GuiContext(const GuiContext&) = delete;
    GuiContext& operator=(const GuiContext&) = delete;
};

/// Loads a font of the system if one of these is installed, else ImGui's default font.
void load_font(float pixels) {
    ImFontAtlas& atlas = *ImGui::GetIO().Fonts;
    atlas.Clear();
    for (const char* file : {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                             "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                             "/usr/share/fonts/TTF/DejaVuSans.ttf",
                             "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
                             "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf",
                             "/System/Library/Fonts/Helvetica.ttc"})
        if (std::filesystem::exists(file) && atlas.AddFontFromFileTTF(file, pixels)) return;
    ImFontConfig config;
    config.SizePixels = std::max(13.0f, pixels * 13 / 15);
    atlas.AddFontDefault(&config);
}

/// First file name that does not exist: vog-1.png, vog-2.png, ...
std::string free_name(const std::string& extension) {
    for (int n = 1;; ++n)
        if (std::string name = fmt::format("vog-{}{}", n, extension);
            !std::filesystem::exists(name))
            return name;
}

/// The viewer with its screen, session and panels.
class Program {
  public:
    explicit Program(const ViewerOptions& options)
        : options_(options),
          screen_(options.headless ? open_headless(options.size) : open_window(options.size)),
          session_(options.read) {
        if (!options.script.empty())
            script_.emplace(options.script);
        else
            gui_.recent = RecentFiles(recent_files_path());
        session_.settings.scale = options.scale;
        // On software OpenGL the CPU splat is about fifty times as fast.
        if (is_software_gl()) session_.settings.renderer = WindowRenderer::splat;
        // Sub-frames are for a camera at rest; a script accumulates what it says.
        if (!options.script.empty()) session_.settings.subframes = 1;
        session_.look = options.look;
        session_.look_changed();
        if (options.extinction > 0) session_.set_first_exposure(options.extinction);
        if (options.camera) session_.first_camera = options.camera;
        session_.quantity = options.quantity;
        session_.set_quantity(options.quantity.show, options.field);
        session_.first_fit = options.fit;
        if (options.color_scale) session_.set_scale(*options.color_scale);
        session_.choose_transfer = options.choose_transfer;
        session_.open_film = options.open_film;
        if (options.layers.scene) session_.set_layers(options.layers);
        if (options.steps)
            session_.open_steps(options.files);
        else if (!options.files.empty())
            session_.open(options.files);
    }

    void run() {
        while (!screen_->close_requested() && !requests_.quit) {
            const Clock::time_point start = Clock::now();
            frame();
            session_.measured.frame_ms = ms_since(start);
            const double fps = 1000 / std::max(0.01, session_.measured.frame_ms);
            gui_.fps += (gui_.fps > 0 ? 0.1 : 1) * (fps - gui_.fps);
            if (script_ && script_->ended()) return;
        }
    }

  private:
    /// Rebuilds style and font for another scale of the user interface.
    void fit_ui(PixelSize size, float points_scale) {
        // Scale of the display; on large frames at least 0.5 per 540 rows, so that text stays
        // legible where the display does not report its density.
        const double by_rows = std::clamp(std::floor(size.height / 540.0) / 2, 1.0, 3.0);
        const double pixels =
            options_.ui_scale > 0 ? options_.ui_scale : std::max(screen_->content_scale(), by_rows);
        const bool light = session_.settings.light_window;
        if (pixels == ui_pixels_ && light == light_) return;
        ui_pixels_ = pixels;
        light_ = light;
        load_font(static_cast<float>(std::lround(15 * pixels)));
        ImGui::GetIO().FontGlobalScale = 1 / points_scale;
        set_style(static_cast<float>(pixels) / points_scale, light);
        gui_gl_.upload_fonts();
    }

    void frame() {
        ImGuiIO& io = ImGui::GetIO();
        // Nothing to draw: the loop waits for events and leaves the cores to other threads.
        const bool idle = session_.at_rest() && !script_ && still_frames_ > 3;
        screen_->begin_frame(io, idle ? 0.5 : session_.drawing() ? 0 : 0.01);
        const PixelSize size = screen_->size();
        if (size.width < 1 || size.height < 1) return;
        const float points_scale = std::max(0.1f, io.DisplayFramebufferScale.x);
        fit_ui(size, points_scale);
        const Layout layout = layout_of(io.DisplaySize.x, io.DisplaySize.y,
                                        static_cast<float>(ui_pixels_) / points_scale,
                                        session_.settings.panels, session_.step_count() > 0);
        if (script_) {
            Stage stage{session_, gui_, *screen_, layout.picture};
            script_->play(stage);
            script_->feed(io);
        }
        ImGui::NewFrame();
        if (const auto files = screen_->take_dropped_files(); !files.empty())
            attempt(session_, [&] { session_.open(files); });
        attempt_or_throw([&] { apply_input(session_, drag_, layout.picture, requests_); });

        const auto to_pixels = [&](float points) {
            return static_cast<int>(std::lround(points * points_scale));
        };
        const PixelSize shown{to_pixels(layout.picture.width), to_pixels(layout.picture.height)};
        attempt_or_throw([&] { session_.update(shown); });
        stop_if_nothing_opens();
        if (std::exchange(opened_, session_.scene.opened) != session_.scene.opened &&
            session_.step_count() == 0)
            attempt(session_, [&] { gui_.recent.add(session_.opened_files); });
        set_title();

        const Clock::time_point gui_start = Clock::now();
        draw_panels(session_, gui_, layout, requests_);
        ImGui::Render();
        session_.measured.gui_ms = ms_since(gui_start);

        screen_->bind();
        glDisable(GL_SCISSOR_TEST);
        glClearColor(0.08f, 0.08f, 0.09f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        session_.draw({0, size.height - shown.height, shown.width, shown.height});
        glViewport(0, 0, size.width, size.height);
        gui_gl_.draw(*ImGui::GetDrawData());
        attempt_or_throw([&] { write_requested(size); });
        if (script_) script_->after_frame({session_, gui_, *screen_, layout.picture});
        screen_->show_frame();
        still_frames_ = session_.at_rest() && !ImGui::IsAnyMouseDown() ? still_frames_ + 1 : 0;
    }

    /// Shows errors in the window; under a script they end the program.
    template <class Action>
    void attempt_or_throw(const Action& action) {
        try {
            action();
        } catch (const Error& error) {
            if (script_) throw;
            session_.show_error(error.what());
        }
    }

    /// throws vog::Error where none of the files given at the start can be opened
    void stop_if_nothing_opens() {
        const std::string& error = session_.loading.error;
        if (!error.empty() && session_.scene.levels.empty() && !options_.files.empty())
            throw Error(error);
    }

    /// Writes the screenshot, picture or depth image requested in this frame.
    void write_requested(PixelSize size) {
        if (std::exchange(requests_.screenshot, false)) {
            screen_->bind();
            Image image = read_picture(size.width, size.height);
            for (Rgba& pixel : image.pixel) pixel.a = 1;  // a window is opaque
            const std::string name = free_name(".png");
            write_png(name, image);
            session_.show_message("wrote " + name);
        }
        if (std::exchange(requests_.full_screen, false)) screen_->toggle_full_screen();
        if (std::exchange(requests_.picture, false)) session_.save_picture(free_name(".png"));
        if (std::exchange(requests_.depth, false)) session_.save_depth(free_name(".exr"));
    }

    void set_title() {
        const std::string title =
            session_.scene.title.empty() ? "vog" : session_.scene.title + " - vog";
        if (title != title_) screen_->set_title(title_ = title);
    }

    const ViewerOptions& options_;
    GuiContext context_;
    std::unique_ptr<Screen> screen_;
    GuiGl gui_gl_;
    Session session_;
    Gui gui_;
    Drag drag_;
    Requests requests_;
    std::optional<ScriptPlayer> script_;
    double ui_pixels_ = 0;
    bool light_ = false;
    int opened_ = 0;  ///< Scene::opened as of the last frame
    int still_frames_ = 0;
    std::string title_;
};

}  // namespace

void run(const ViewerOptions& options) {
    require_size(options.size);
    Program(options).run();
}

}  // namespace vog::viewer
