#include "client/gpu/overlay_panels.hpp"

#include <fmt/format.h>
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/vec4.hpp>
#include <utility>

#include "client/gpu/key_bindings.hpp"
#include "client/scene/debug_lines.hpp"
#include "client/scene/layer_names.hpp"
#include "protocol/units/version.hpp"

namespace trochoid {

namespace {

const ImVec4 lit{1.0F, 0.85F, 0.3F, 1.0F};
const ImVec4 pale{0.62F, 0.68F, 0.75F, 1.0F};
const ImVec4 warning{1.0F, 0.55F, 0.4F, 1.0F};

constexpr ImGuiWindowFlags plain_window = ImGuiWindowFlags_AlwaysAutoResize |
                                          ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse |
                                          ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing;

/// Width of so many characters.
float wide(float characters) { return ImGui::GetFontSize() * 0.54F * characters; }

void row(const char* name, const std::string& value, const ImVec4* colour = nullptr) {
    ImGui::TableNextRow();
    ImGui::TableNextColumn();
    ImGui::TextColored(pale, "%s", name);
    ImGui::TableNextColumn();
    if (colour != nullptr)
        ImGui::TextColored(*colour, "%s", value.c_str());
    else
        ImGui::TextUnformatted(value.c_str());
}

/// "3 d 04:05:06.7"
std::string time_text(SeaTime t) {
    const int64_t seconds = t.us / microseconds_per_second;
    return fmt::format("{}{:02}:{:02}:{:04.1f}",
                       seconds >= 86'400 ? fmt::format("{} d ", seconds / 86'400) : "", seconds / 3600 % 24,
                       seconds / 60 % 60, static_cast<double>(t.us % (60 * microseconds_per_second)) * 1e-6);
}

std::string hour_text(double hour) {
    const int minutes = static_cast<int>(std::lround(hour * 60.0)) % (24 * 60);
    return fmt::format("{:02}:{:02}", minutes / 60, minutes % 60);
}

std::string bytes_text(double bytes) {
    if (bytes < 10e3) return fmt::format("{:.0f} B", bytes);
    if (bytes < 10e6) return fmt::format("{:.1f} kB", bytes * 1e-3);
    return fmt::format("{:.1f} MB", bytes * 1e-6);
}

std::string count_text(uint32_t count) {
    return count < 10'000 ? fmt::format("{}", count) : fmt::format("{:.0f} k", count * 1e-3);
}

/// Words with commas, in lines that keep the panel narrow.
std::vector<std::string> joined(const std::vector<std::string>& words) {
    constexpr size_t line_characters = 46;
    std::vector<std::string> lines;
    for (const std::string& word : words) {
        if (!lines.empty()) lines.back() += ',';
        if (lines.empty() || lines.back().size() + word.size() > line_characters)
            lines.push_back(word);
        else
            lines.back() += ' ' + word;
    }
    return lines;
}

void budget_rows(const BudgetReport& b) {
    const bool late = b.verdict == BudgetVerdict::exhausted;
    row("Target", fmt::format("{:.1f} ms: takes {:.1f}, {}", b.target_ms, b.load_ms, name_of(b.verdict)),
        late ? &warning : nullptr);
    std::vector<std::string> given;
    if (b.error_factor > 1.005) given.push_back(fmt::format("mesh {:.1f} times as coarse", b.error_factor));
    for (const Sacrifice what : b.given_up) given.emplace_back(name_of(what));
    const char* name = "Given up";
    for (const std::string& line : joined(given)) row(std::exchange(name, ""), line);
}

void picture_rows(const OverlayContent& c) {
    row("Frames", fmt::format("{:.1f} /s   {:.1f} ms   CPU {:.1f}   GPU {:.1f}", c.frames_per_second,
                              c.frame_ms, c.report.cpu_ms, c.report.gpu_ms));
    if (c.budget) budget_rows(*c.budget);
    row("Sea", fmt::format("{} triangles in {} draws, patches {} of {}", count_text(c.report.sea_triangles),
                           c.report.draws, c.report.patches_drawn, c.report.patches_known));
    row("Land", c.report.land_blocks_left_out == 0
                    ? fmt::format("{} triangles, {} field blocks", count_text(c.report.land_triangles),
                                  c.report.land_blocks)
                    : fmt::format("{} triangles, {} field blocks, no room for {}",
                                  count_text(c.report.land_triangles), c.report.land_blocks,
                                  c.report.land_blocks_left_out));
    row("Wave trains", fmt::format("{} in {} boxes", c.report.trains, c.report.boxes));
    if (c.trains) {
        row("Here", fmt::format("{} of {} trains shown, at most {:.2f} m lost", c.trains->shown,
                                c.trains->known, c.trains->lost_m));
        row("", fmt::format("the best {} {} {:.2f} m; not sent: {:.2f} m", c.trains->shown,
                            c.trains->best_proven ? "lose" : "lose about", c.trains->best_lost_m,
                            c.trains->server_left_out_m));
    }
    row("Vertices", fmt::format("{:.1f} px of error, 1/{:.0f} of the distance apart",
                                static_cast<double>(c.options.error_px),
                                1.0 / static_cast<double>(std::max(c.report.vertex_angle, 1e-6F))));
}

void choice_rows(const OverlayContent& c) {
    const DrawOptions& o = c.options;
    std::string mesher(name_of(o.mesher));
    if (o.mesher == MesherKind::uniform)
        mesher += fmt::format(" {} x {} m", o.grid_cells, static_cast<double>(o.grid_spacing_m));
    if (o.mesher == MesherKind::projected)
        mesher += fmt::format(", attention {:.2f}", static_cast<double>(o.attention));
    row("Mesher", fmt::format("{}, refined by {}", mesher, name_of(refinement_in_force(o))));
    row("Shown", fmt::format("{}, far {}, {} light", name_of(o.displacement), name_of(o.far_method),
                             hour_text(o.hour)));
    const std::string scale = o.render_scale < 1.0F ? fmt::format(", {:.0f} % of the resolution",
                                                                  static_cast<double>(o.render_scale) * 100.0)
                                                    : "";
    row("Quality", fmt::format("{}, {} sample{} a pixel{}{}{}{}", name_of(c.quality), o.samples,
                               o.samples == 1 ? "" : "s", scale, o.lean ? ", lean" : "",
                               c.preset.empty() ? "" : ", preset ", c.preset));
}

void source_rows(const OverlayContent& c) {
    row("Camera", fmt::format("x {:.1f}  z {:.1f}  {:.1f} m up  {:.0f} m/s", to_metres(c.camera.position.x),
                              to_metres(c.camera.position.z), c.camera.altitude_m, c.speed));
    row("Sea time", time_text(c.now) + (c.time_held ? ", held" : ""));
    row("Server",
        fmt::format("{}, {}", c.source.server_version.empty() ? "not known yet" : c.source.server_version,
                    c.source.state));
    row("Received",
        fmt::format("{} /s, {} in all, clock within {:.1f} ms", bytes_text(c.source.bytes_per_second),
                    bytes_text(static_cast<double>(c.source.bytes_received)), c.source.clock_error_ms));
    row("Results", fmt::format("{}, resyncs {}, desyncs {}, log {}, {}", c.source.deltas, c.source.resyncs,
                               c.source.desyncs, c.source.log_position,
                               c.source.fidelity == Fidelity::unknown
                                   ? "not compared yet"
                                   : fmt::format("{} viewer", name_of(c.source.fidelity))));
}

void word(const std::string& text, bool on) {
    ImGui::TextColored(on ? lit : pale, "%s", text.c_str());
    ImGui::SameLine();
}

void legend(const char* text, Tint tint) {
    ImGui::TextColored(ImVec4(static_cast<float>(tint[0]) / 255.0F, static_cast<float>(tint[1]) / 255.0F,
                              static_cast<float>(tint[2]) / 255.0F, 1.0F),
                       "%s", text);
    ImGui::SameLine();
}

/// What a key switches, lit where it is on; more than fit go to further lines.
class Switches {
public:
    void add(const std::string& text, bool on) {
        const auto length = static_cast<float>(text.size() + 2);
        if (used_ > 0.0F && used_ + length > line_characters) next_line();
        used_ += length;
        word(text, on);
    }
    void next_line() {
        if (used_ > 0.0F) ImGui::NewLine();
        used_ = 0.0F;
    }

private:
    static constexpr float line_characters = 58.0F;
    float used_ = 0.0F;
};

void switch_rows(const OverlayContent& c) {
    Switches s;
    int digit = 0;
    for (const NamedLayer& l : layers_by_importance)
        s.add(fmt::format("{} {}", ++digit, l.name), c.options.layers.has(l.layer));
    s.next_line();
    s.add("K spray", c.options.spray);
    s.add("J foam stays", c.options.foam_history);
    s.add("L ships", c.options.ships);
    s.next_line();
    s.add("F2 wireframe", c.options.wireframe);
    s.add("F3 boxes", c.options.boxes);
    s.add("F4 rays", c.options.rays);
    s.add("F5 patches", c.options.patches);
    s.add("F6 fields", c.options.fields);
    s.add("F7 frozen", c.frozen.has_value());
    s.add("B bird's eye", c.birds_eye);
    s.add("H all keys", false);
    s.next_line();
    if (!c.options.rays) return;
    legend("shoaling starts", tint_of(ActionKind::shoaling_starts));
    legend("blocked", tint_of(ActionKind::blocked));
    legend("water again", tint_of(ActionKind::water_again));
    legend("recovered", tint_of(ActionKind::recovered));
    ImGui::NewLine();
}

ImU32 colour_of_frame(float ms, double target_ms) {
    if (target_ms <= 0.0) return IM_COL32(120, 185, 235, 255);
    if (ms <= target_ms * 1.05) return IM_COL32(110, 205, 130, 255);
    return ms <= target_ms * 1.5 ? IM_COL32(240, 200, 80, 255) : IM_COL32(235, 105, 85, 255);
}

/// Bars of the last frames, the newest at the right, with the target as a line.
void frame_graph(const OverlayContent& c) {
    constexpr size_t most = 120;
    const double target = c.budget ? c.budget->target_ms : 0.0;
    float top = static_cast<float>(target) * 1.5F;
    for (const float ms : c.frame_times_ms) top = std::max(top, ms);
    // Round steps, so that the scale does not tremble.
    const float step = std::pow(10.0F, std::floor(std::log10(std::max(top, 1.0F))));
    top = std::ceil(std::max(top, 1.0F) / step) * step;
    const ImVec2 size(wide(44), ImGui::GetFontSize() * 5.0F);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy(size);
    ImDrawList* list = ImGui::GetWindowDrawList();
    list->AddRectFilled(at, ImVec2(at.x + size.x, at.y + size.y), IM_COL32(0, 0, 0, 90));
    const float width = size.x / static_cast<float>(most);
    const size_t first = most - std::min(most, c.frame_times_ms.size());
    for (size_t i = first; i < most; ++i) {
        const float ms = c.frame_times_ms[c.frame_times_ms.size() - (most - i)];
        const float x = at.x + static_cast<float>(i) * width;
        const float height = std::min(ms / top, 1.0F) * size.y;
        list->AddRectFilled(ImVec2(x, at.y + size.y - height),
                            ImVec2(x + std::max(width - 1.0F, 1.0F), at.y + size.y),
                            colour_of_frame(ms, target));
    }
    if (target > 0.0) {
        const float y = at.y + size.y - static_cast<float>(target) / top * size.y;
        list->AddLine(ImVec2(at.x, y), ImVec2(at.x + size.x, y), IM_COL32(255, 255, 255, 170));
    }
    list->AddText(ImVec2(at.x + 3.0F, at.y + 1.0F), IM_COL32(255, 255, 255, 170),
                  fmt::format("{:.0f} ms", static_cast<double>(top)).c_str());
}

void pass_rows(const FrameReport& report) {
    double longest = 0.1;
    for (const PassTime& pass : report.passes) longest = std::max(longest, pass.ms);
    if (report.passes_waited) ImGui::TextColored(pale, "each pass waited for");
    if (!ImGui::BeginTable("passes", 3, ImGuiTableFlags_SizingFixedFit)) return;
    for (const PassTime& pass : report.passes) {
        ImGui::TableNextRow();
        ImGui::TableNextColumn();
        ImGui::TextColored(pale, "%s", pass.name);
        ImGui::TableNextColumn();
        ImGui::TextUnformatted(fmt::format("{:8.2f} ms", pass.ms).c_str());
        ImGui::TableNextColumn();
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const ImVec2 size(wide(20), ImGui::GetFontSize());
        ImGui::Dummy(size);
        const auto share = static_cast<float>(std::clamp(pass.ms / longest, 0.0, 1.0));
        ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x, at.y + size.y * 0.15F),
                                                  ImVec2(at.x + size.x * share, at.y + size.y * 0.9F),
                                                  IM_COL32(120, 185, 235, 200));
    }
    ImGui::EndTable();
}

/// A triangle that points along a direction (unit vector, y down).
void draw_arrow(ImDrawList& list, ImVec2 at, ImVec2 ahead) {
    const float length = ImGui::GetFontSize();
    const auto triangle = [&](float grow, ImU32 colour) {
        const float l = length * grow;
        const auto corner = [&](float along, float aside) {
            return ImVec2(at.x + (ahead.x * along - ahead.y * aside) * l,
                          at.y + (ahead.y * along + ahead.x * aside) * l);
        };
        list.AddTriangleFilled(corner(1.0F, 0.0F), corner(-0.7F, -0.55F), corner(-0.7F, 0.55F), colour);
    };
    triangle(1.25F, IM_COL32(0, 0, 0, 160));
    triangle(1.0F, IM_COL32(255, 220, 80, 255));
}

/// What the frozen camera sees, as lines on still water: its place, and the left and right edge of its picture out to 30 km.
void draw_sight(ImDrawList& list, const Camera& camera, const Camera& frozen) {
    const CameraFrame frame = frame_of(camera, DepthRange::classic);
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const glm::vec3 place = metres_from_camera(frame, frozen.position, 0.0);
    const auto in_picture = [&](glm::vec3 metres) {
        const glm::vec4 clip = frame.clip_from_camera * glm::vec4(metres, 1.0F);
        const float w = std::max(clip.w, 1e-3F);
        return ImVec2((clip.x / w * 0.5F + 0.5F) * size.x, (0.5F - clip.y / w * 0.5F) * size.y);
    };
    const auto towards = [&](double yaw, float metres) {
        return place +
               glm::vec3(static_cast<float>(std::sin(yaw)), 0.0F, static_cast<float>(-std::cos(yaw))) *
                   metres;
    };
    const double aspect =
        static_cast<double>(frozen.width) / static_cast<double>(std::max(frozen.height, 1U));
    const double half = std::atan(std::tan(frozen.vertical_angle / 2) * aspect);
    const ImVec2 from = in_picture(place);
    for (const double edge : {frozen.yaw - half, frozen.yaw + half}) {
        list.AddLine(from, in_picture(towards(edge, 30'000.0F)), IM_COL32(0, 0, 0, 140), 4.0F);
        list.AddLine(from, in_picture(towards(edge, 30'000.0F)), IM_COL32(255, 220, 80, 255), 2.0F);
    }
    const ImVec2 ahead = in_picture(towards(frozen.yaw, static_cast<float>(camera.altitude_m) * 0.1F));
    const float length = std::max(std::hypot(ahead.x - from.x, ahead.y - from.y), 1e-3F);
    draw_arrow(list, from, ImVec2((ahead.x - from.x) / length, (ahead.y - from.y) / length));
}

void help_table(const char* name, size_t first, size_t last) {
    if (!ImGui::BeginTable(name, 2, ImGuiTableFlags_SizingFixedFit)) return;
    size_t shown = 0;
    for (const KeyBinding& binding : key_bindings()) {
        if (binding.shown.empty()) continue;
        if (shown >= first && shown < last) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextColored(lit, "%s", std::string(binding.shown).c_str());
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(std::string(binding.about).c_str());
        }
        ++shown;
    }
    ImGui::EndTable();
}

}  // namespace

void draw_numbers_panel(const OverlayContent& content) {
    ImGui::SetNextWindowPos(ImVec2(wide(1.5F), wide(1.5F)), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowBgAlpha(0.6F);
    const std::string title = fmt::format("Trochoid {}###overlay", software_version());
    ImGui::Begin(title.c_str(), nullptr, plain_window);
    if (ImGui::BeginTable("numbers", 2, ImGuiTableFlags_SizingFixedFit)) {
        picture_rows(content);
        choice_rows(content);
        source_rows(content);
        if (!content.recording.empty()) row("Recording", content.recording, &warning);
        ImGui::EndTable();
    }
    ImGui::Separator();
    switch_rows(content);
    ImGui::End();
}

void draw_timers_panel(const OverlayContent& content) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x - wide(1.5F), wide(1.5F)), ImGuiCond_FirstUseEver,
                            ImVec2(1.0F, 0.0F));
    ImGui::SetNextWindowBgAlpha(0.6F);
    const std::string title =
        fmt::format("{:.1f} ms a frame, GPU {:.1f} ms###timers", content.frame_ms, content.report.gpu_ms);
    ImGui::Begin(title.c_str(), nullptr, plain_window);
    frame_graph(content);
    pass_rows(content.report);
    ImGui::End();
}

void draw_help_panel() {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x * 0.5F, size.y * 0.5F), ImGuiCond_Always, ImVec2(0.5F, 0.5F));
    ImGui::SetNextWindowBgAlpha(0.85F);
    ImGui::Begin("Keys###help", nullptr, plain_window | ImGuiWindowFlags_NoMove);
    size_t count = 0;
    for (const KeyBinding& binding : key_bindings()) count += binding.shown.empty() ? 0U : 1U;
    ImGui::BeginGroup();
    help_table("keys one", 0, (count + 1) / 2);
    ImGui::EndGroup();
    ImGui::SameLine(0.0F, wide(4));
    ImGui::BeginGroup();
    help_table("keys two", (count + 1) / 2, count);
    ImGui::EndGroup();
    ImGui::Separator();
    if (ImGui::BeginTable("held", 2, ImGuiTableFlags_SizingFixedFit)) {
        for (const HeldControl& control : held_controls()) {
            ImGui::TableNextRow();
            ImGui::TableNextColumn();
            ImGui::TextColored(lit, "%s", std::string(control.shown).c_str());
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(std::string(control.about).c_str());
        }
        ImGui::EndTable();
    }
    ImGui::End();
}

void draw_notice(const std::string& text, int line) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float up = ImGui::GetFontSize() * (1.8F + 2.4F * static_cast<float>(line));
    ImGui::SetNextWindowPos(ImVec2(size.x * 0.5F, size.y - up), ImGuiCond_Always, ImVec2(0.5F, 1.0F));
    ImGui::SetNextWindowBgAlpha(0.7F);
    ImGui::Begin(fmt::format("###notice{}", line).c_str(), nullptr,
                 plain_window | ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs);
    ImGui::TextUnformatted(text.c_str());
    ImGui::End();
}

void draw_map_marks(const Camera& camera, const std::optional<Camera>& frozen) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    const float length = ImGui::GetFontSize();
    ImDrawList* list = ImGui::GetBackgroundDrawList();
    if (frozen)
        draw_sight(*list, camera, *frozen);
    else
        // Up in the picture is where one would look on coming down.
        draw_arrow(*list, ImVec2(size.x * 0.5F, size.y * 0.5F), ImVec2(0.0F, -1.0F));
    // North, at the upper edge.
    const ImVec2 rose(size.x * 0.5F, length * 3.2F);
    const auto turn = static_cast<float>(-camera.yaw);
    const ImVec2 north(std::sin(turn) * length * 1.6F, -std::cos(turn) * length * 1.6F);
    list->AddCircleFilled(rose, length * 2.0F, IM_COL32(0, 0, 0, 110));
    list->AddLine(ImVec2(rose.x - north.x * 0.6F, rose.y - north.y * 0.6F),
                  ImVec2(rose.x + north.x * 0.5F, rose.y + north.y * 0.5F), IM_COL32(255, 255, 255, 200),
                  2.0F);
    list->AddText(ImVec2(rose.x + north.x * 0.8F - wide(0.5F), rose.y + north.y * 0.8F - length * 0.5F),
                  IM_COL32(255, 255, 255, 255), "N");
}

}  // namespace trochoid
