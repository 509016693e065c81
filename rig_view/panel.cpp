#include "rig_view/panel.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "rig_view/words.hpp"

namespace foresight {
namespace {

constexpr int kMargin = 14, kLegendRow = 19;
constexpr int kTallest = 38, kLowest = 20;  // rows of joints
const cv::Scalar kPaper(252, 251, 250), kInk(40, 32, 26), kGrey(130, 122, 114), kTrack(215, 210, 206),
    kMark(115, 26, 217), kGood(70, 130, 30);

std::string value_text(const RigJoint& joint, double value) {
  if (joint.unit == "m") return fmt::format("{:.1f} mm", 1e3 * value);
  return fmt::format("{:.1f} deg  {:.3f} rad", value * 180 / std::numbers::pi, value);
}

std::string end_text(const RigJoint& joint, double value) {
  return joint.unit == "m" ? fmt::format("{:.0f}", 1e3 * value) : fmt::format("{:.0f}", value * 180 / std::numbers::pi);
}

void draw_joint(cv::Mat& picture, const RigJoint& joint, double value, bool selected, const PanelLayout& layout,
                std::size_t number) {
  const cv::Rect row = layout.row(number), slider = layout.slider(number);
  if (selected) cv::rectangle(picture, row, cv::Scalar(240, 232, 222), cv::FILLED);
  const int base = row.y + 13;
  put_text(picture, joint.drive.name, {row.x + 4, base}, 0.42, kInk, 128, 1);
  put_text(picture, value_text(joint, value), {row.x + 138, base}, 0.42, kInk, row.width - 142);
  const int middle = slider.y + slider.height / 2;
  cv::line(picture, {slider.x, middle}, {slider.x + slider.width, middle}, kTrack, 4, cv::LINE_AA);
  const double share = (value - joint.drive.min_position) / (joint.drive.max_position - joint.drive.min_position);
  const int at = slider.x + cvRound(std::clamp(share, 0.0, 1.0) * slider.width);
  cv::circle(picture, {at, middle}, 5, share < 0 || share > 1 ? bgr(kBadColour) : kMark, cv::FILLED, cv::LINE_AA);
  if (row.height < kTallest) return;
  put_text(picture, end_text(joint, joint.drive.min_position), {row.x + 4, middle + 4}, 0.34, kGrey);
  put_text(picture, end_text(joint, joint.drive.max_position), {slider.x + slider.width + 8, middle + 4}, 0.34, kGrey);
}

void draw_legend(cv::Mat& picture, const Rig& rig, const PanelState& state, const PanelLayout& layout) {
  for (std::size_t i = 0; i < kLayers; ++i) {
    const LayerStyle& style = style_of(static_cast<Layer>(i));
    const cv::Rect row = layout.legend(i);
    const cv::Scalar colour = bgr(style.colour);
    cv::rectangle(picture, cv::Rect(row.x, row.y + 3, 20, 11), colour, state.layers[i] ? cv::FILLED : 1);
    std::string text = fmt::format("{} {}", i + 1, style.name);
    if (static_cast<Layer>(i) == Layer::guards) text += ", red: too close";
    if (static_cast<Layer>(i) == Layer::obstacles)
      text += fmt::format(", orange: clearance {:.0f} mm", 1e3 * rig.surroundings.clearance);
    if (static_cast<Layer>(i) == Layer::cameras) text += ": " + state.about_cameras;
    if (static_cast<Layer>(i) == Layer::frames) text = fmt::format("{} frames: red x, green y, blue z", i + 1);
    put_text(picture, text, {row.x + 28, row.y + 13}, 0.40, state.layers[i] ? kInk : kGrey, row.width - 28);
  }
}

/// "link 'arm_5' comes too close to obstacle 'table'" as "arm_5 - table".
std::string short_form(std::string text) {
  for (const auto& [what, instead] : {std::pair{" comes too close to ", " - "},
                                      {" leaves the workspace", " - workspace's end"},
                                      {"link ", ""},
                                      {"obstacle ", ""},
                                      {"'", ""}})
    for (auto at = text.find(what); at != std::string::npos; at = text.find(what))
      text.replace(at, std::string_view(what).size(), instead);
  return text;
}

void draw_couples(cv::Mat& picture, const PlacedRig& placed, const cv::Rect& room, std::size_t foot) {
  int base = room.y + 14;
  const int last = room.y + room.height - static_cast<int>(foot) * 16;
  if (placed.couples.empty()) {
    if (base < last)
      put_text(picture, "the gate guards no link: no robot.urdf", {room.x, base}, 0.40, kGrey, room.width);
    return;
  }
  if (base < last) put_text(picture, "nearest, and how far from a stop", {room.x, base}, 0.42, kInk, room.width);
  for (const NearCouple& couple : placed.couples) {
    base += 17;
    if (base > last || couple.margin_m > 0.5) break;
    const cv::Scalar colour = couple.margin_m < 0      ? bgr(kBadColour)
                              : couple.margin_m < 0.03 ? bgr(kClearanceColour)
                                                       : kGood;
    put_text(picture, fmt::format("{:.0f} mm", 1e3 * couple.margin_m), {room.x, base}, 0.38, colour);
    put_text(picture, short_form(couple.text), {room.x + 68, base}, 0.38, kInk, room.width - 68);
  }
}

}  // namespace

PanelLayout::PanelLayout(std::size_t joints, int height) : joints_(joints) {
  const int room = height - top_ - static_cast<int>(kLayers) * kLegendRow - 150;
  row_height_ = std::clamp(room / std::max(1, static_cast<int>(joints)), kLowest, kTallest);
}

cv::Rect PanelLayout::row(std::size_t joint) const {
  return {kMargin - 6, top_ + static_cast<int>(joint) * row_height_, kPanelWidth - 2 * kMargin + 12, row_height_};
}

cv::Rect PanelLayout::slider(std::size_t joint) const {
  const cv::Rect r = row(joint);
  if (row_height_ < 30) return {r.x + 138, r.y + 14, r.width - 150, 6};  // below the value
  return {r.x + 40, r.y + 18, r.width - 84, 11};
}

cv::Rect PanelLayout::legend(std::size_t layer) const {
  const int first = top_ + static_cast<int>(joints_) * row_height_ + 14;
  return {kMargin, first + static_cast<int>(layer) * kLegendRow, kPanelWidth - 2 * kMargin, kLegendRow};
}

cv::Rect PanelLayout::rest() const {
  const cv::Rect last = legend(kLayers - 1);
  return {kMargin, last.y + last.height + 10, last.width, 1 << 20};
}

std::optional<std::size_t> PanelLayout::joint_at(cv::Point p) const {
  for (std::size_t i = 0; i < joints_; ++i)
    if (row(i).contains(p)) return i;
  return std::nullopt;
}

std::optional<std::size_t> PanelLayout::layer_at(cv::Point p) const {
  for (std::size_t i = 0; i < kLayers; ++i)
    if (legend(i).contains(p)) return i;
  return std::nullopt;
}

double PanelLayout::position_at(const DriveConfig& drive, std::size_t joint, int column) const {
  const cv::Rect s = slider(joint);
  const double share = std::clamp((column - s.x) / static_cast<double>(s.width), 0.0, 1.0);
  return drive.min_position + share * (drive.max_position - drive.min_position);
}

void draw_panel(cv::Mat picture, const Rig& rig, const PanelState& state, const PlacedRig& placed) {
  picture.setTo(kPaper);
  cv::line(picture, {0, 0}, {0, picture.rows}, kTrack, 1);
  put_text(picture, state.title, {kMargin, 28}, 0.62, kInk, kPanelWidth - 2 * kMargin, 1);
  const std::string live =
      state.live.empty() ? fmt::format("{} joints, turned by hand", rig.joints.size()) : state.live;
  put_text(picture, live, {kMargin, 50}, 0.42, state.live_is_bad ? bgr(kBadColour) : kGrey, kPanelWidth - 2 * kMargin);
  const PanelLayout layout(rig.joints.size(), picture.rows);
  for (std::size_t i = 0; i < rig.joints.size(); ++i)
    draw_joint(picture, rig.joints[i], state.positions[i], static_cast<int>(i) == state.selected, layout, i);
  draw_legend(picture, rig, state, layout);
  cv::Rect room = layout.rest();
  room.height = picture.rows - room.y - 8;
  if (room.height > 20) draw_couples(picture, placed, room, state.help.size());
  for (std::size_t i = 0; i < state.help.size(); ++i)
    put_text(picture, state.help[i], {kMargin, picture.rows - 8 - static_cast<int>(state.help.size() - 1 - i) * 16},
             0.38, kGrey, kPanelWidth - 2 * kMargin);
}

}  // namespace foresight
