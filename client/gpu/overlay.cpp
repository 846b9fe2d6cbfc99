#include "client/gpu/overlay.hpp"

#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <string>

#include "client/scene/debug_lines.hpp"
#include "client/scene/layer_names.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

void row(const char* name, const std::string& value) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(name);
    ImGui::TableNextColumn();
    ImGui::TextUnformatted(value.c_str());
}

/// "3 d 04:05:06.7"
std::string time_text(SeaTime t) {
    const int64_t seconds = t.us / microseconds_per_second;
    return fmt::format("{}{:02}:{:02}:{:04.1f}",
                       seconds >= 86'400 ? fmt::format("{} d ", seconds / 86'400) : "", seconds / 3600 % 24,
                       seconds / 60 % 60, static_cast<double>(t.us % (60 * microseconds_per_second)) * 1e-6);
}

std::string bytes_text(double bytes) {
    if (bytes < 10e3) return fmt::format("{:.0f} B", bytes);
    if (bytes < 10e6) return fmt::format("{:.1f} kB", bytes * 1e-3);
    return fmt::format("{:.1f} MB", bytes * 1e-6);
}

void picture_rows(const OverlayContent& c) {
    row("Frames", fmt::format("{:.1f} /s   {:.1f} ms", c.frames_per_second, c.frame_ms));
    row("CPU, GPU", fmt::format("{:.1f} ms, {:.1f} ms", c.report.cpu_ms, c.report.gpu_ms));
    row("Patches", fmt::format("{} drawn of {}   {} draws", c.report.patches_drawn, c.report.patches_known,
                               c.report.draws));
    row("Triangles", fmt::format("sea {}   land {}", c.report.sea_triangles, c.report.land_triangles));
    row("Wave trains", fmt::format("{} in {} boxes", c.report.trains, c.report.boxes));
    row("Land blocks",
        c.report.land_blocks_left_out == 0
            ? fmt::format("{}", c.report.land_blocks)
            : fmt::format("{}, no room for {}", c.report.land_blocks, c.report.land_blocks_left_out));
    row("Vertex spacing", fmt::format("1/{:.0f} of the distance",
                                      1.0 / static_cast<double>(std::max(c.report.vertex_angle, 1e-6F))));
    row("Camera", fmt::format("x {:.1f}  z {:.1f}  {:.1f} m up  {:.0f} m/s", to_metres(c.camera.position.x),
                              to_metres(c.camera.position.z), c.camera.altitude_m, c.speed));
}

void source_rows(const OverlayContent& c) {
    row("Sea time", time_text(c.now));
    row("Server", c.source.server_version.empty() ? "not known yet" : c.source.server_version);
    row("Link", c.source.state);
    row("Received", fmt::format("{} /s   {} in all", bytes_text(c.source.bytes_per_second),
                                bytes_text(static_cast<double>(c.source.bytes_received))));
    row("Clock", fmt::format("within {:.1f} ms", c.source.clock_error_ms));
    row("This client", c.source.fidelity == Fidelity::unknown
                           ? "not compared yet"
                           : fmt::format("{} viewer", name_of(c.source.fidelity)));
    row("Results",
        fmt::format("{}   resyncs {}   log {}", c.source.deltas, c.source.resyncs, c.source.log_position));
    row("Culled by", fmt::format("{:.1f} px", static_cast<double>(c.source.error_in_force_px)));
}

void key(const char* text, bool on) {
    ImGui::TextColored(on ? ImVec4(1.0F, 0.85F, 0.3F, 1.0F) : ImVec4(0.75F, 0.78F, 0.82F, 1.0F), "%s", text);
    ImGui::SameLine();
}

void legend(const char* text, Tint tint) {
    ImGui::TextColored(ImVec4(static_cast<float>(tint[0]) / 255.0F, static_cast<float>(tint[1]) / 255.0F,
                              static_cast<float>(tint[2]) / 255.0F, 1.0F),
                       "%s", text);
    ImGui::SameLine();
}

void key_rows(const OverlayContent& c) {
    key("F2 wireframe", c.options.wireframe);
    key("F3 boxes", c.options.boxes);
    key("F4 rays", c.options.rays);
    key("F5 patches", c.options.patches);
    ImGui::NewLine();
    key("F6 land fields", c.options.fields);
    key("F7 freeze culling", c.frozen);
    key("F1 this", true);
    ImGui::NewLine();
    if (!c.options.rays) return;
    legend("shoaling starts", tint_of(ActionKind::shoaling_starts));
    legend("blocked", tint_of(ActionKind::blocked));
    legend("water again", tint_of(ActionKind::water_again));
    legend("recovered", tint_of(ActionKind::recovered));
    ImGui::NewLine();
}

/// What the sea is made of, in order of importance; the digit switches a layer.
void layer_rows(const OverlayContent& c) {
    int digit = 0;
    for (const NamedLayer& l : layers_by_importance) {
        ++digit;
        key(fmt::format("{} {}", digit, l.name).c_str(), c.options.layers.has(l.layer));
        if (digit % 3 == 0) ImGui::NewLine();
    }
}

constexpr ImGuiWindowFlags plain_window = ImGuiWindowFlags_AlwaysAutoResize |
                                          ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                                          ImGuiWindowFlags_NoNav;

void draw_numbers(const OverlayContent& content) {
    ImGui::SetNextWindowPos(ImVec2(12.0F, 12.0F), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowBgAlpha(0.55F);
    const std::string title = fmt::format("Trochoid {}###overlay", software_version());
    ImGui::Begin(title.c_str(), nullptr, plain_window);
    if (ImGui::BeginTable("numbers", 2, ImGuiTableFlags_SizingFixedFit)) {
        picture_rows(content);
        source_rows(content);
        ImGui::EndTable();
    }
    ImGui::Separator();
    layer_rows(content);
    ImGui::Separator();
    key_rows(content);
    ImGui::End();
}

/// At the picture's lower edge.
void draw_notice(const std::string& text) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x * 0.5F, size.y - 24.0F), ImGuiCond_Always, ImVec2(0.5F, 1.0F));
    ImGui::SetNextWindowBgAlpha(0.7F);
    ImGui::Begin("###notice", nullptr,
                 plain_window | ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs);
    ImGui::TextUnformatted(text.c_str());
    ImGui::End();
}

}  // namespace

Overlay::Overlay(const Window* window) : windowed_(window != nullptr) {
    ImGui::CreateContext();
    ImGui::GetIO().IniFilename = nullptr;
    ImGui::StyleColorsDark();
    if (windowed_) ImGui_ImplGlfw_InitForOpenGL(window->handle(), true);
    ImGui_ImplOpenGL3_Init("#version 410 core");
}

Overlay::~Overlay() {
    ImGui_ImplOpenGL3_Shutdown();
    if (windowed_) ImGui_ImplGlfw_Shutdown();
    ImGui::DestroyContext();
}

void Overlay::draw(const OverlayContent& content, bool numbers, uint32_t width, uint32_t height) const {
    const bool notice = !content.source.connected && !content.source.state.empty();
    if (!numbers && !notice) return;
    ImGui_ImplOpenGL3_NewFrame();
    if (windowed_) {
        ImGui_ImplGlfw_NewFrame();
    } else {
        ImGui::GetIO().DisplaySize = ImVec2(static_cast<float>(width), static_cast<float>(height));
        ImGui::GetIO().DeltaTime = std::max(static_cast<float>(content.frame_ms) * 1e-3F, 1e-4F);
    }
    ImGui::NewFrame();
    if (numbers) draw_numbers(content);
    if (notice) draw_notice(content.source.state);
    ImGui::Render();
    ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
}

}  // namespace trochoid
