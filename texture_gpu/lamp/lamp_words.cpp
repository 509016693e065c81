#include "texture_gpu/lamp/lamp_words.hpp"

#include <fmt/core.h>

#include "common/counted.hpp"

namespace foresight {
namespace {

double in_seconds(RobotTime time) {
  return to_seconds(time - RobotTime{});
}

std::string on_lamp(const LampAnswer& answer, RobotTime known_from) {
  const Eigen::Vector3d& p = answer.lamp->position;
  std::string out = fmt::format(
      "The main lamp is at ({:.2f}, {:.2f}, {:.2f}) m, found by shadows {}: those of what moves are shown where they "
      "fall, with images from {:.3f} s on.",
      p.x(), p.y(), p.z(), answer.told_by_what_moves ? "of what moves" : "in single images", in_seconds(known_from));
  if (answer.told_by_what_moves)
    out += fmt::format(" They explain {:.0f} % of what was darker or brighter than usual.", 100 * answer.explained);
  return out;
}

std::string on_no_lamp(const LampAnswer& answer) {
  if (answer.several)
    return "Shadows tell of another lamp that is not much weaker than the main one. With several lamps, shadows of "
           "what moves are shown where they were.";
  if (answer.dark > 0)
    return fmt::format(
        "It could not be told where the main lamp is: shadows of what moves are shown where they were. Of what was "
        "darker or brighter than usual ({} points), the best place explains {:.0f} %, the best elsewhere {:.0f} %.",
        answer.dark, 100 * answer.explained, 100 * answer.elsewhere);
  return {};
}

}  // namespace

void LampHistory::add(const LampAnswer& answer, RobotTime image) {
  answer_ = answer;
  if (answer.lamp) {
    if (!known_) known_ = {image, image};
    known_->last = image;
    ++known_->images;
  } else if (known_) {
    if (!before_) before_ = {known_->first, known_->last};
    before_->last = known_->last;
    before_->images += known_->images;
    known_.reset();
  }
}

std::string LampHistory::in_words() const {
  std::string out = known_ ? on_lamp(answer_, known_->first) : on_no_lamp(answer_);
  if (!before_) return out;
  if (!out.empty()) out += ' ';
  return out + fmt::format(
                   "Before, one was believed to be known, and its shadows were shown, with {} from {:.3f} to "
                   "{:.3f} s.",
                   counted(before_->images, "image"), in_seconds(before_->first), in_seconds(before_->last));
}

}  // namespace foresight
