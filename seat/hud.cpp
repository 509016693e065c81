#include "seat/hud.hpp"

#include <fmt/core.h>
#include <imgui.h>

#include <backends/imgui_impl_opengl3.h>

#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>
#include <span>

#include "common/error.hpp"
#include "seat/seat_keys.hpp"

namespace foresight {
namespace {

constexpr float kFontPx = 16;
constexpr float kAround = 8;           // px around panels
constexpr float kWordsAt = 115;        // px from a panel's left: what a line says
constexpr float kKeyDoesAt = 138;      // px from a panel's left: what a key does
constexpr float kSmall = 0.8f;         // of the usual letters, where these leave no room
constexpr std::size_t kLeastKeys = 4;  // the first ones: what is not urgent makes way for them
constexpr float kLeastPanel = 300;     // px: of two panels of lines side by side, each
constexpr float kBesideInset = 0.75f;  // of the width: what the newest image in its corner leaves to the title
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

std::string row_of(const SeatLine& line) {
  return line.cure.empty() ? line.words : line.words + " - " + line.cure;
}

std::string cure_of_next(const SeatLine& next) {
  return "   " + next.cure;
}

constexpr float kOneRow = std::numeric_limits<float>::max();

/// px, in rows of at most `width`.
ImVec2 size_of(const std::string& text, const ImFont& font, float width) {
  return font.CalcTextSizeA(font.FontSize, kOneRow, std::max(1.0f, width), text.data(), text.data() + text.size());
}

/// px, of the panel; its rows end `wrap` from its left.
ImVec2 size_of_next(const SeatLine& next, const ImFont& font, float wrap) {
  if (next.words.empty()) return {0, 0};
  const ImGuiStyle& style = ImGui::GetStyle();
  const float width = wrap - style.WindowPadding.x;
  ImVec2 out = size_of(mark(next.urgency) + next.words, font, width);
  if (!next.cure.empty()) {
    const ImVec2 cure = size_of(cure_of_next(next), font, width);
    out = {std::max(out.x, cure.x), out.y + style.ItemSpacing.y + cure.y};
  }
  return {out.x + 2 * style.WindowPadding.x, out.y + 2 * style.WindowPadding.y};
}

/// px, of the panel.
float width_of_keys(const std::vector<std::pair<std::string, std::string>>& keys, const ImFont& font, float scale) {
  float out = 0;
  for (const auto& [key, does] : keys) out = std::max(out, size_of(does, font, kOneRow).x);
  return kKeyDoesAt * scale + out + ImGui::GetStyle().WindowPadding.x;
}

std::span<const std::pair<std::string, std::string>> keys_left(const HudContent& content) {
  return std::span(content.keys).subspan(std::min(content.first_key, content.keys.size()));
}

/// px, of the panel with so many of those that are left; what they do is in rows that end `wrap` from its left.
float height_of_keys(const HudContent& content, std::size_t count, const ImFont& font, float scale, float wrap) {
  if (count == 0) return 0;
  const ImGuiStyle& style = ImGui::GetStyle();
  const auto left = keys_left(content);
  float height = 2 * style.WindowPadding.y;
  for (const auto& [key, does] : left.first(count))
    height += size_of(does, font, wrap - kKeyDoesAt * scale).y + style.ItemSpacing.y;
  return count < left.size() ? height + font.FontSize + style.ItemSpacing.y : height;  // the row that says so
}

/// How many of `rows` (px) go into the first of two panels, below its title, such that the higher one is as low as can
/// be.
std::size_t rows_of_first(std::span<const float> rows, float title) {
  float first = title, second = std::accumulate(rows.begin(), rows.end(), 0.0f);
  std::size_t out = 0;
  for (; out < rows.size() && first + rows[out] < second; ++out) first += rows[out], second -= rows[out];
  return out;
}

std::string words_on_left_out(const HudContent& content) {
  if (content.clear) return fmt::format("more lines in other views ({})", printed(SeatKey::main_view));
  return content.first_key > 0 ? "more lines without these keys" : "more lines in a larger window";
}

void write(const SeatLine& line, float words_at, float width) {
  ImGui::PushStyleColor(ImGuiCol_Text, colour(line.urgency));
  write(mark(line.urgency) + line.label);
  ImGui::SameLine(words_at);
  ImGui::PushTextWrapPos(width);
  write(row_of(line));
  ImGui::PopTextWrapPos();
  ImGui::PopStyleColor();
}

}  // namespace

struct Hud::Work {
  struct Text {
    float scale;  // of letters and distances; 1: letters of kFontPx
    ImFont *usual, *large;
  };
  /// Panels of which none is over another.
  struct Layout {
    Text text;
    float wrap = 0, title_wrap = 0, keys_wrap = 0;  // px from a panel's left where rows end
    ImVec2 next = {0, 0};                           // px, the panel of what is next
    bool keys_beside_next = false;
    bool two_panels = false;                  // of lines
    float lines_height = 0;                   // px, the panel of lines, or the higher one
    std::vector<const SeatLine*> lines = {};  // that there is room for
    std::size_t in_first = 0;                 // of the rows below the title: in the first panel
    float least_keys_height = 0;              // px, the panel of the first keys
  };
  ImGuiContext* context;
  std::vector<Text> texts;  // as wanted, and small

  explicit Work(double wanted) : context(ImGui::CreateContext()) {
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
    for (const float share : {1.0f, kSmall}) {
      const float scale = share * static_cast<float>(wanted);
      texts.push_back({scale, add(kFontPx * scale), add(1.5f * kFontPx * scale)});
    }
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
  std::size_t draw(const HudContent& content, const HudArea& area) const;
  Layout layout(const HudContent& content, float width, float height) const;
  Layout widths(const HudContent& content, const Text& text, float width) const;
  void measure_lines(const HudContent& content, Layout& layout) const;
  void draw_next(const SeatLine& next, ImVec2 corner, float width, const Text& text) const;
  void draw_lines(const HudContent& content, ImVec2 corner, float width, const Layout& layout) const;
  std::size_t draw_keys(const HudContent& content, ImVec2 corner, float room, const Layout& layout) const;
  void draw(const std::vector<HudLabel>& labels, float width, float height) const;
};

// Beside their places, behind the panels, none over another.
void Hud::Work::draw(const std::vector<HudLabel>& labels, float width, float height) const {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float scale = texts.front().scale, pad = 3 * scale, beside = 34 * scale;
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

void Hud::Work::measure_lines(const HudContent& content, Layout& layout) const {
  const ImGuiStyle& style = ImGui::GetStyle();
  const ImFont& font = *layout.text.usual;
  const float words_width = layout.wrap - kWordsAt * layout.text.scale;
  const float title = size_of(content.title, font, layout.title_wrap - style.WindowPadding.x).y + style.ItemSpacing.y;
  std::vector<float> rows;
  for (const SeatLine* line : layout.lines)
    rows.push_back(style.ItemSpacing.y + size_of(row_of(*line), font, words_width).y);
  if (layout.lines.size() < content.lines.size())
    rows.push_back(style.ItemSpacing.y + font.FontSize);  // the row that says so
  layout.in_first = layout.two_panels ? rows_of_first(rows, title) : rows.size();
  const auto second = rows.begin() + static_cast<std::ptrdiff_t>(layout.in_first);
  layout.lines_height =
      std::max(std::accumulate(rows.begin(), second, title), std::accumulate(second, rows.end(), 0.0f)) +
      2 * style.WindowPadding.y;
}

/// Of a layout in such letters: all that does not depend on the height.
Hud::Work::Layout Hud::Work::widths(const HudContent& content, const Text& text, float width) const {
  const float gap = kAround * texts.front().scale, padding = ImGui::GetStyle().WindowPadding.x;
  const float all_of_it = std::max(1.0f, width - 2 * gap - padding), half = 0.5f * width - 2 * gap - padding;
  Layout out{text};
  out.two_panels = content.clear && half >= kLeastPanel * text.scale;
  out.wrap = out.two_panels ? half : std::clamp(0.5f * width, std::min(380 * text.scale, all_of_it), 700 * text.scale);
  out.title_wrap = out.two_panels ? half : std::max(out.wrap, kBesideInset * width - 3 * gap);
  out.keys_wrap = all_of_it;
  out.next = size_of_next(content.next, *text.large, width - 4 * gap);
  out.keys_beside_next = width_of_keys(content.keys, *text.usual, text.scale) + out.next.x + 3 * gap <= width;
  return out;
}

// In small letters where the usual ones leave no room, then without the lines that matter least, then without keys.
Hud::Work::Layout Hud::Work::layout(const HudContent& content, float width, float height) const {
  const float gap = kAround * texts.front().scale;
  std::vector<const SeatLine*> all;
  for (const SeatLine& line : content.lines) all.push_back(&line);
  Layout out;
  const auto below = [&](std::size_t keys) {
    const float keys_height = height_of_keys(content, keys, *out.text.usual, out.text.scale, out.keys_wrap);
    return out.keys_beside_next ? std::max(out.next.y, keys_height) : out.next.y + (keys > 0 ? keys_height + gap : 0);
  };
  const auto fits = [&](std::size_t keys, bool over_pictures) {
    measure_lines(content, out);
    if (!over_pictures && content.clear && out.lines_height + 2 * gap > content.clear->top) return false;
    return out.lines_height + below(keys) + 3 * gap <= height;
  };
  const std::size_t left = keys_left(content).size();
  const bool are_asked_for = content.first_key > 0 && !content.clear;
  const std::size_t least_keys = are_asked_for ? left : std::min(kLeastKeys, left);
  for (const Text& text : texts) {
    out = widths(content, text, width);
    out.least_keys_height = height_of_keys(content, least_keys, *text.usual, text.scale, out.keys_wrap);
    out.lines = all;
    const bool is_clear_below = !content.clear || content.clear->bottom + below(least_keys) + 2 * gap <= height;
    if (is_clear_below && fits(least_keys, false)) return out;
  }
  std::ranges::stable_sort(all, std::ranges::greater(), &SeatLine::urgency);
  out.lines.clear();
  for (const SeatLine* line : all) {
    out.lines.push_back(line);
    const bool is_trouble = line->urgency == Urgency::trouble;
    if (!fits(is_trouble ? 0 : least_keys, is_trouble)) out.lines.pop_back();
  }
  std::ranges::sort(out.lines);  // in the order of the content
  measure_lines(content, out);
  return out;
}

void Hud::Work::draw_next(const SeatLine& next, ImVec2 corner, float width, const Text& text) const {
  if (next.words.empty()) return;
  panel("next", corner, {1, 1});
  ImGui::PushFont(text.large);
  ImGui::PushTextWrapPos(std::max(1.0f, width));
  ImGui::PushStyleColor(ImGuiCol_Text, colour(next.urgency));
  write(mark(next.urgency) + next.words);
  if (!next.cure.empty()) write(cure_of_next(next));
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  ImGui::PopFont();
  ImGui::End();
}

void Hud::Work::draw_lines(const HudContent& content, ImVec2 corner, float width, const Layout& layout) const {
  const std::span lines(layout.lines);
  const std::size_t left_out = content.lines.size() - lines.size();
  const std::size_t in_first = std::min(layout.in_first, lines.size());
  const bool has_second = layout.in_first < lines.size() + (left_out > 0 ? 1 : 0);
  const auto write_rows = [&](std::span<const SeatLine* const> some, bool are_last) {
    for (const SeatLine* line : some) write(*line, kWordsAt * layout.text.scale, layout.wrap);
    if (are_last && left_out > 0) write(words_on_left_out(content));
  };
  panel("lines", corner, {0, 0});
  ImGui::PushFont(layout.text.usual);
  ImGui::PushTextWrapPos(layout.title_wrap);
  write(content.title);
  ImGui::PopTextWrapPos();
  ImGui::Separator();
  write_rows(lines.first(in_first), !has_second);
  ImGui::PopFont();
  ImGui::End();
  if (!has_second) return;
  panel("lines beside", {corner.x + 0.5f * width, corner.y}, {0, 0});
  ImGui::PushFont(layout.text.usual);
  write_rows(lines.subspan(in_first), true);
  ImGui::PopFont();
  ImGui::End();
}

// As many as there is room for. How many that were.
std::size_t Hud::Work::draw_keys(const HudContent& content, ImVec2 corner, float room, const Layout& layout) const {
  const Text& text = layout.text;
  const auto left = keys_left(content);
  std::size_t fit = left.size();
  while (fit > 0 && height_of_keys(content, fit, *text.usual, text.scale, layout.keys_wrap) > room) --fit;
  if (fit == 0) return 0;
  panel("keys", corner, {0, 1});
  ImGui::PushFont(text.usual);
  ImGui::PushTextWrapPos(layout.keys_wrap);
  for (const auto& [key, does] : left.first(fit)) {
    write(key);
    ImGui::SameLine(kKeyDoesAt * text.scale);
    write(does);
  }
  if (fit < left.size()) write(fmt::format("{}: {} more keys", printed(SeatKey::help), left.size() - fit));
  ImGui::PopTextWrapPos();
  ImGui::PopFont();
  ImGui::End();
  return fit;
}

// Which key is the next one.
std::size_t Hud::Work::draw(const HudContent& content, const HudArea& area) const {
  const float gap = kAround * texts.front().scale;
  const auto width = static_cast<float>(area.width), height = static_cast<float>(area.height);
  const float left = static_cast<float>(area.left) + gap, top = static_cast<float>(area.top) + gap;
  const float right = left + width - 2 * gap, bottom = top + height - 2 * gap;
  const Layout fit = layout(content, width, height);
  draw_next(content.next, {right, bottom}, width - 4 * gap, fit.text);
  draw_lines(content, {left, top}, width, fit);
  const float keys_end = fit.keys_beside_next ? bottom : bottom - fit.next.y - gap;
  float keys_room = keys_end - (top + fit.lines_height + gap);
  if (content.clear) {
    const float below = keys_end - static_cast<float>(area.top + content.clear->bottom) - gap;
    keys_room = std::min(keys_room, std::max(below, fit.least_keys_height));
  }
  return content.first_key + draw_keys(content, {left, keys_end}, keys_room, fit);
}

std::optional<std::size_t> keys_after(std::optional<std::size_t> first, std::size_t next, std::size_t count) {
  if (!first) return 0;
  return next > *first && next < count ? std::optional(next) : std::nullopt;
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
  // Panels are not shown before their size is known: two frames go ahead.
  for (const bool is_seen : {false, false, true}) {
    ImGui::NewFrame();
    work_->draw(content.labels, io.DisplaySize.x, io.DisplaySize.y);
    next_key_ = work_->draw(content, content.area.value_or(HudArea{0, 0, io.DisplaySize.x, io.DisplaySize.y}));
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
