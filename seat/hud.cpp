#include "seat/hud.hpp"

#include <imgui.h>

#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <filesystem>
#include <ranges>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr float kFontPx = 16;
constexpr float kWordsAt = 115;           // px from a panel's left: what a line says
constexpr float kBesideEachOther = 1100;  // px of width that keys and what is next need
constexpr ImGuiWindowFlags kPanel = ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoInputs |
                                    ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoBringToFrontOnFocus;
const char* const kFonts[] = {"/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf"};

ImVec4 colour(Urgency urgency) {
  switch (urgency) {
    case Urgency::fine: return {0.92f, 0.94f, 0.96f, 1};
    case Urgency::note: return {1.00f, 0.86f, 0.45f, 1};
    case Urgency::trouble: return {1.00f, 0.62f, 0.55f, 1};
  }
  return {1, 1, 1, 1};
}

void write(const std::string& text) {
  ImGui::TextUnformatted(text.data(), text.data() + text.size());
}

void write(const SeatLine& line, float words_at, float width) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour(line.urgency));
  write(mark(line.urgency) + line.label);
  ImGui::SameLine(words_at);
  ImGui::PushTextWrapPos(width);
  write(line.cure.empty() ? line.words : line.words + " - " + line.cure);
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

}  // namespace

struct Hud::Work {
  ImGuiContext* context;
  ImFont* large = nullptr;
  float scale;

  explicit Work(double wanted) : context(ImGui::CreateContext()), scale(static_cast<float>(wanted)) {
    ImGui::SetCurrentContext(context);
    ImGuiIO& io = ImGui::GetIO();
    io.IniFilename = io.LogFilename = nullptr;
    const auto font = std::ranges::find_if(kFonts, [](const char* file) { return std::filesystem::exists(file); });
    const auto add = [&](float px) {
      if (font != std::end(kFonts)) return io.Fonts->AddFontFromFileTTF(*font, px);
      ImFontConfig config;
      config.SizePixels = px;
      return io.Fonts->AddFontDefault(&config);
    };
    add(kFontPx * scale);
    large = add(1.5f * kFontPx * scale);
    if (!ImGui_ImplOpenGL3_Init("#version 330"))
      throw RuntimeFailure("the head-up display cannot be drawn", "check the graphics driver");
    ImGui::GetStyle().WindowRounding = 4;
    ImGui::GetStyle().WindowBorderSize = 0;
  }
  ~Work() {
    ImGui::SetCurrentContext(context);
    ImGui_ImplOpenGL3_Shutdown();
    ImGui::DestroyContext(context);
  }

  void panel(const char* name, ImVec2 at, ImVec2 pivot) const {
    ImGui::SetNextWindowPos(at, ImGuiCond_Always, pivot);
    ImGui::SetNextWindowBgAlpha(0.62f);
    ImGui::Begin(name, nullptr, kPanel);
  }
  void draw(const HudContent& content, const HudArea& area) const;
  float draw_next(const SeatLine& next, ImVec2 corner, float width) const;        // px that it is high
  float draw_lines(const HudContent& content, ImVec2 corner, float width) const;  // likewise
  void draw_keys(const HudContent& content, ImVec2 corner, float room) const;
  void draw(const std::vector<HudLabel>& labels, float width, float height) const;
};

// Beside their places, behind the panels, none over another.
void Hud::Work::draw(const std::vector<HudLabel>& labels, float width, float height) const {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float pad = 3 * scale, beside = 34 * scale;
  std::vector<ImVec4> taken;  // left, top, right, bottom
  for (const HudLabel& label : labels) {
    const std::string words = mark(label.urgency) + label.words;
    const ImVec2 size = ImGui::CalcTextSize(words.data(), words.data() + words.size());
    const float w = size.x + 2 * pad, h = size.y + 2 * pad;
    const auto place = [](double wanted, float room) {
      return std::clamp(static_cast<float>(wanted), 0.0f, std::max(0.0f, room));
    };
    const float left = place(label.x + beside, width - w);
    float top = place(label.y - 0.5 * h, height - h);
    const auto covers = [&](const ImVec4& other) {
      return left < other.z && other.x < left + w && top < other.w && other.y < top + h;
    };
    for (std::size_t tries = 0; tries < labels.size() && std::ranges::any_of(taken, covers); ++tries)
      top = std::ranges::find_if(taken, covers)->w + 1;
    if (top + h > height) continue;
    taken.emplace_back(left, top, left + w, top + h);
    list.AddLine({static_cast<float>(label.x), static_cast<float>(label.y)}, {left, top + 0.5f * h},
                 IM_COL32(15, 15, 18, 200), 2 * scale);
    list.AddRectFilled({left, top}, {left + w, top + h}, IM_COL32(15, 15, 18, 190), 3 * scale);
    list.AddText({left + pad, top + pad}, ImGui::ColorConvertFloat4ToU32(colour(label.urgency)), words.data(),
                 words.data() + words.size());
  }
}

float Hud::Work::draw_next(const SeatLine& next, ImVec2 corner, float width) const {
  if (next.words.empty()) return 0;
  panel("next", corner, {1, 1});
  ImGui::PushFont(large);
  ImGui::PushTextWrapPos(std::max(1.0f, width));
  ImGui::PushStyleColor(ImGuiCol_Text, colour(next.urgency));
  write(mark(next.urgency) + next.words);
  if (!next.cure.empty()) write("   " + next.cure);
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  ImGui::PopFont();
  const float height = ImGui::GetWindowHeight();
  ImGui::End();
  return height;
}

float Hud::Work::draw_lines(const HudContent& content, ImVec2 corner, float width) const {
  const float gap = 8 * scale;
  panel("lines", corner, {0, 0});
  const float wrap = std::clamp(0.5f * width, std::min(380 * scale, std::max(1.0f, 0.7f * width)), 700 * scale);
  ImGui::PushTextWrapPos(std::max(wrap, width - 4 * gap));
  write(content.title);
  ImGui::PopTextWrapPos();
  ImGui::Separator();
  for (const SeatLine& line : content.lines) write(line, kWordsAt * scale, wrap);
  const float height = ImGui::GetWindowHeight();
  ImGui::End();
  return height;
}

// As many as there is room for.
void Hud::Work::draw_keys(const HudContent& content, ImVec2 corner, float room) const {
  const float rows = (room - 2 * ImGui::GetStyle().WindowPadding.y) / ImGui::GetTextLineHeightWithSpacing();
  if (content.keys.empty() || rows < 1) return;
  panel("keys", corner, {0, 1});
  const bool all_fit = static_cast<float>(content.keys.size()) <= rows;
  const auto fit = all_fit ? std::ssize(content.keys) : static_cast<std::ptrdiff_t>(rows) - 1;
  for (const auto& [key, does] : content.keys | std::views::take(fit)) {
    write(key);
    ImGui::SameLine(1.2f * kWordsAt * scale);
    write(does);
  }
  if (!all_fit) write("more keys in a larger window");
  ImGui::End();
}

// What matters more comes first: where there is little room, later panels are behind earlier ones.
void Hud::Work::draw(const HudContent& content, const HudArea& area) const {
  const float gap = 8 * scale;
  const auto width = static_cast<float>(area.width);
  const float left = static_cast<float>(area.left) + gap, top = static_cast<float>(area.top) + gap;
  const float right = left + width - 2 * gap, bottom = top + static_cast<float>(area.height) - 2 * gap;
  const float next = draw_next(content.next, {right, bottom}, width - 4 * gap);
  const float lines = draw_lines(content, {left, top}, width);
  const float keys_end = width < kBesideEachOther * scale ? bottom - next - gap : bottom;
  draw_keys(content, {left, keys_end}, keys_end - (top + lines + gap));
}

Hud::Hud(double scale) : work_(std::make_unique<Work>(scale)) {}

Hud::~Hud() = default;

void Hud::draw(const HudContent& content, const ViewTarget& target) {
  if (target.width < 1 || target.height < 1) return;
  ImGui::SetCurrentContext(work_->context);
  ImGuiIO& io = ImGui::GetIO();
  io.DisplaySize = {static_cast<float>(target.width), static_cast<float>(target.height)};
  io.DeltaTime = 1.0f / 60;
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  ImGui_ImplOpenGL3_NewFrame();
  // Panels are not shown before their size is known, nor keys before that of the lines: two frames go ahead.
  for (const bool is_seen : {false, false, true}) {
    ImGui::NewFrame();
    work_->draw(content.labels, io.DisplaySize.x, io.DisplaySize.y);
    work_->draw(content, content.area.value_or(HudArea{0, 0, io.DisplaySize.x, io.DisplaySize.y}));
    is_seen ? ImGui::Render() : ImGui::EndFrame();
  }
  // It draws into what begins in the framebuffer's first row and column: the target lies in that, to the right and
  // above.
  ImDrawData* const data = ImGui::GetDrawData();
  const auto x = static_cast<float>(target.x), y = static_cast<float>(target.y);
  data->DisplayPos = {-x, 0};
  data->DisplaySize = {x + io.DisplaySize.x, y + io.DisplaySize.y};
  ImGui_ImplOpenGL3_RenderDrawData(data);
}

}  // namespace foresight
