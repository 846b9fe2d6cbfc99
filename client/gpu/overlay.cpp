#include "client/gpu/overlay.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "client/gpu/overlay_panels.hpp"

namespace trochoid {

Overlay::Overlay(const Window* window, float text_scale) : window_(window), wanted_scale_(text_scale) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    if (window_ != nullptr) ImGui_ImplGlfw_InitForOpenGL(window_->handle(), true);
    ImGui_ImplOpenGL3_Init("#version 410 core");
    follow_density();
}

Overlay::~Overlay() {
    ImGui_ImplOpenGL3_Shutdown();
    if (window_ != nullptr) ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

/// Text of the right size for the screen that the window is on, which may change while it is open.
void Overlay::follow_density() {
    const float display = window_ != nullptr ? window_->text_scale() : 1.0F;
    const float scale = wanted_scale_ > 0.0F ? wanted_scale_ : display;
    if (std::abs(scale - scale_) < 0.01F) return;
    scale_ = scale;
    ImGui::GetStyle() = ImGuiStyle();
    ImGui::StyleColorsDark();
    ImGuiStyle& style = ImGui::GetStyle();
    style.WindowRounding = 5.0F;
    style.WindowBorderSize = 0.0F;
    style.CellPadding = ImVec2(4.0F, 1.0F);
    style.ItemSpacing = ImVec2(8.0F, 3.0F);
    style.Colors[ImGuiCol_TitleBg] = style.Colors[ImGuiCol_TitleBgActive] = ImVec4(0.05F, 0.10F, 0.16F, 0.8F);
    style.ScaleAllSizes(scale_);
    ImFontConfig font;
    font.SizePixels = std::round(13.0F * scale_);
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    io.Fonts->AddFontDefault(&font);
    // Made anew by the next NewFrame, with its device objects.
    ImGui_ImplOpenGL3_DestroyDeviceObjects();
}

void Overlay::draw(const OverlayContent& content, OverlayPanels panels, uint32_t width, uint32_t height) {
    const bool trouble = !content.source.connected && !content.source.state.empty();
    const bool nothing =
        panels == OverlayPanels{} && !trouble && content.notice.empty() && !content.birds_eye;
    // With a window the library has to see that nothing is shown, or it goes on taking the mouse for a panel that is gone.
    if (nothing && window_ == nullptr) return;
    follow_density();
    ImGui_ImplOpenGL3_NewFrame();
    if (window_ != nullptr) {
        ImGui_ImplGlfw_NewFrame();
    } else {
        ImGui::GetIO().DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
        ImGui::GetIO().DeltaTime = std::max(static_cast<float>(content.frame_ms) * 1e-3F, 1e-4F);
    }
    ImGui::NewFrame();
    if (content.birds_eye) draw_map_marks(content.camera, content.frozen);
    if (panels.numbers) draw_numbers_panel(content);
    if (panels.timers) draw_timers_panel(content);
    if (panels.help) draw_help_panel();
    int line = 0;
    if (trouble) draw_notice(content.source.state, line++);
    if (!content.notice.empty()) draw_notice(content.notice, line);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace trochoid
