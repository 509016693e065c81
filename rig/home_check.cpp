#include "rig/home_check.hpp"

#include "rig/home.hpp"

namespace foresight {
namespace {

const char* cure_of(bool touch) {
  return touch ? "correct surroundings, robot.pose or the joint's offset: the gate lets it only part"
               : "leave more room, or less surroundings.clearance_m: the gate lets them only part";
}

}  // namespace

std::vector<TooClose> parts_too_close_at_home(const Rig& rig) {
  const auto shape = rig.shape();
  if (!shape) return {};
  shape->surround(rig.surroundings);
  const JointValues home = home_of(rig);
  std::vector<double> margins(shape->couples());
  shape->margins({home.data(), rig.joints.size()}, margins);
  std::vector<TooClose> out;
  for (std::size_t i = 0; i < margins.size(); ++i) {
    const bool touch = shape->kept_apart(i) + margins[i] <= 0;
    if (margins[i] < 0) out.push_back({shape->message(i), touch, cure_of(touch)});
  }
  return out;
}

std::vector<std::string> words_on_home(std::span<const TooClose> all) {
  std::vector<std::string> out;
  for (const TooClose& parts : all) out.push_back("at home " + parts.what + "; " + parts.cure);
  return out;
}

}  // namespace foresight
