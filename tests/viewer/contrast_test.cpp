// contrast_test.cpp: contrast of the window's texts by WCAG 2.2 AA: at least 4.5 against all that they are drawn on, over black and
// white pictures, on dark and light panels.
#include <imgui.h>

#include <cmath>
#include <span>
#include <thread>

#include "gl/gui_gl.h"
#include "ui/panels.h"
#include "viewer/headless.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/sample.h"

namespace vog::test {

using namespace viewer;

namespace {

constexpr double kLeast = 4.5;
constexpr float kWindowWidth = 1280, kWindowHeight = 1000;

Vec3d color_of(ImU32 color) {
    const ImVec4 c = ImGui::ColorConvertU32ToFloat4(color);
    return {double{c.x}, double{c.y}, double{c.z}};
}
double alpha_of(ImU32 color) { return double{ImGui::ColorConvertU32ToFloat4(color).w}; }
Vec3d over(ImU32 front, Vec3d back) {
    return alpha_of(front) * color_of(front) + (1 - alpha_of(front)) * back;
}

double luminance(Vec3d color) {
    const auto linear = [](double v) {
        return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
    };
    return 0.2126 * linear(color.x) + 0.7152 * linear(color.y) + 0.0722 * linear(color.z);
}
double contrast(Vec3d a, Vec3d b) {
    const double high = std::max(luminance(a), luminance(b)),
                 low = std::min(luminance(a), luminance(b));
    return (high + 0.05) / (low + 0.05);
}

/// A triangle of one colour.
struct Fill {
    ImVec2 corner[3];
    ImVec4 clip;
    ImU32 color;
    bool covers(ImVec2 p) const {
        if (p.x < clip.x || p.y < clip.y || p.x >= clip.z || p.y >= clip.w) return false;
        const auto side = [&](ImVec2 a, ImVec2 b) {
            return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        };
        const float s[] = {side(corner[0], corner[1]), side(corner[1], corner[2]),
                           side(corner[2], corner[0])};
        return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0);
    }
};

struct Measured {
    std::size_t letters = 0;
    double least = 1e9;
    ImVec2 at{};  ///< letter of the least contrast
};

/// Contrasts of all letters of what ImGui drew last against all that was filled below each before it.
/// ground  colour of the window below: of the picture, or beside it
Measured measure(const ImDrawData& data, const std::function<Vec3d(ImVec2)>& ground) {
    const ImVec2 white = ImGui::GetIO().Fonts->TexUvWhitePixel;
    std::vector<Fill> fills;
    Measured found;
    for (int n = 0; n < data.CmdListsCount; ++n) {
        const ImDrawList& list = *data.CmdLists[n];
        for (const ImDrawCmd& command : list.CmdBuffer)
            for (unsigned i = 0; i + 2 < command.ElemCount; i += 3) {
                const auto vertex = [&](unsigned k) -> const ImDrawVert& {
                    const ImDrawIdx index =
                        list.IdxBuffer[static_cast<int>(command.IdxOffset + i + k)];
                    return list.VtxBuffer[static_cast<int>(command.VtxOffset + index)];
                };
                const ImDrawVert &a = vertex(0), &b = vertex(1), &c = vertex(2);
                const bool filled = a.uv.x == white.x && a.uv.y == white.y && b.uv.x == white.x &&
                                    b.uv.y == white.y && c.uv.x == white.x && c.uv.y == white.y;
                if (filled) {
                    if (a.col == b.col && b.col == c.col)
                        fills.push_back({{a.pos, b.pos, c.pos}, command.ClipRect, a.col});
                    continue;
                }
                if (i + 5 >= command.ElemCount) continue;
                // Two triangles of a letter: corners a and c are opposite.
                i += 3;
                // Beside the middle, which may lie on the edge of two triangles.
                const ImVec2 at{0.5f * (a.pos.x + c.pos.x) + 0.13f,
                                0.5f * (a.pos.y + c.pos.y) + 0.07f};
                const ImVec4& clip = command.ClipRect;
                if (at.x < clip.x || at.y < clip.y || at.x >= clip.z || at.y >= clip.w) continue;
                Vec3d below = ground(at);
                for (const Fill& fill : fills)
                    if (fill.covers(at)) below = over(fill.color, below);
                const double ratio = contrast(over(a.col, below), below);
                ++found.letters;
                if (ratio < found.least) found.least = ratio, found.at = at;
            }
    }
    return found;
}

}  // namespace

class window_contrast : public headless {
  protected:
    void SetUp() override {
        headless::SetUp();
        if (IsSkipped()) return;
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.DisplaySize = {kWindowWidth, kWindowHeight};
        io.Fonts->AddFontDefault();
        gui_gl_.emplace();
        gui_gl_->upload_fonts();
    }
    void TearDown() override {
        gui_gl_.reset();
        if (ImGui::GetCurrentContext()) ImGui::DestroyContext();
    }
    /// Draws some frames, and measures the last one over pictures of black and white.
    void expect_legible(Session& session, bool light, const char* what) {
        SCOPED_TRACE(std::string(what) + (light ? ", light" : ", dark"));
        session.settings.light_window = light;
        set_style(1, light);
        ImGui::GetStyle().AntiAliasedLinesUseTex = false;  // whose texture looks like a letter's
        const Layout layout =
            layout_of(kWindowWidth, kWindowHeight, 1, true, session.step_count() > 0);
        for (int n = 0; n < 4; ++n) {
            ImGui::GetIO().DeltaTime = 1 / 60.0f;
            ImGui::NewFrame();
            session.update({64, 48});  // the picture itself has no texts
            draw_panels(session, gui_, layout, requests_);
            ImGui::Render();
        }
        for (const double picture : {0.0, 1.0}) {
            SCOPED_TRACE(picture);
            const Measured found = measure(*ImGui::GetDrawData(), [&](ImVec2 at) {
                const bool beside = !layout.picture.holds(at.x, at.y);
                return beside ? Vec3d{0.08, 0.08, 0.09} : Vec3d{picture, picture, picture};
            });
            EXPECT_GE(found.least, kLeast)
                << "of the letter at " << found.at.x << ", " << found.at.y;
            EXPECT_GT(found.letters, 300u);
        }
    }

    std::optional<GuiGl> gui_gl_;
    Gui gui_;
    Requests requests_;
};

TEST_F(window_contrast, texts_of_every_quantity_are_legible) {
    MomentOptions options;
    options.block_voxels = 8;
    options.own_field = "density";
    const Gaussians model = convert_moments(sample_cloud({.size = 64}), options);
    Session session([&](const std::vector<std::string>&) {
        viewer::Content content;
        content.model = model;
        return content;
    });
    for (const bool light : {false, true}) expect_legible(session, light, "nothing open");
    session.open({"cloud.ply"});
    for (const bool light : {false, true}) {
        session.loading = {true, "reading cloud.ply", 0.5, {}};
        expect_legible(session, light, "loading");
    }
    while (!session.loaded() || session.scene.levels.empty()) {
        session.update({64, 64});
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    for (const bool light : {false, true}) {
        for (const Show show : {Show::depth, Show::column, Show::mean, Show::deviation,
                                Show::volume, Show::maximum}) {
            session.set_quantity(show);
            expect_legible(session, light, word_of(show));
        }
        session.set_clip(session.scene.subject.box);
        session.quantity.look.light = true;
        session.settings.split_on = true;
        session.settings.other = WindowRenderer::splat;
        session.show_error("cloud.ply: no grid named 'x'");
        expect_legible(session, light, "clip, light, split and an error");
        session.settings.split_on = false;
        session.settings.difference = true;
        session.show_message("wrote vog-1.png");
        expect_legible(session, light, "difference");
        session.settings.difference = false;
        session.settings.help = true;
        expect_legible(session, light, "help");
        session.settings.help = false;
        session.set_clip({});
        for (const char* axis : {"+x", "-y", "+z"}) {
            session.set_view(axis);
            expect_legible(session, light, axis);
        }
    }
}

TEST_F(window_contrast, controls_under_the_pointer_are_legible) {
    for (const bool light : {false, true}) {
        SCOPED_TRACE(light);
        set_style(1, light);
        const auto color = [](ImGuiCol n) { return ImGui::GetColorU32(n); };
        const Vec3d text = color_of(color(ImGuiCol_Text));
        for (const ImGuiCol window : {ImGuiCol_WindowBg, ImGuiCol_PopupBg}) {
            const Vec3d panel = over(color(window), {0.08, 0.08, 0.09});
            for (const ImGuiCol ground :
                 {ImGuiCol_FrameBg, ImGuiCol_FrameBgHovered, ImGuiCol_FrameBgActive,
                  ImGuiCol_Button, ImGuiCol_ButtonHovered, ImGuiCol_ButtonActive, ImGuiCol_Header,
                  ImGuiCol_HeaderHovered, ImGuiCol_HeaderActive, ImGuiCol_TitleBg,
                  ImGuiCol_TitleBgActive, ImGuiCol_TextSelectedBg, ImGuiCol_SliderGrab,
                  ImGuiCol_SliderGrabActive})
                EXPECT_GE(contrast(text, over(color(ground), panel)), kLeast)
                    << ImGui::GetStyleColorName(ground);
            EXPECT_GE(contrast(color_of(color(ImGuiCol_TextDisabled)), panel), kLeast);
        }
    }
}

}  // namespace vog::test
