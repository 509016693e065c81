#include "texture_gpu/lamp/lamp_words.hpp"

#include <fmt/core.h>

namespace foresight {

std::string lamp_in_words(const LampAnswer& answer, RobotTime known_from) {
  if (answer.lamp) {
    const Eigen::Vector3d& p = answer.lamp->position;
    std::string out = fmt::format(
        "The main lamp is at ({:.2f}, {:.2f}, {:.2f}) m, found by shadows {}: those of what moves are shown where they "
        "fall, with images from {:.3f} s on.",
        p.x(), p.y(), p.z(), answer.told_by_what_moves ? "of what moves" : "in single images",
        static_cast<double>(known_from.ns) * 1e-9);
    if (answer.told_by_what_moves)
      out += fmt::format(" They explain {:.0f} % of what was darker or brighter than usual.", 100 * answer.explained);
    return out;
  }
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

}  // namespace foresight
