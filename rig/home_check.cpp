#include "rig/home_check.hpp"

#include "rig/home.hpp"

namespace foresight {

std::vector<TooClose> parts_too_close_at_home(const Rig& rig) {
  const auto shape = rig.shape();
  if (!shape) return {};
  shape->surround(rig.surroundings);
  const JointValues home = home_of(rig);
  std::vector<double> margins(shape->couples());
  shape->margins({home.data(), rig.joints.size()}, margins);
  std::vector<TooClose> out;
  for (std::size_t i = 0; i < margins.size(); ++i)
    if (margins[i] < 0) out.push_back({shape->message(i), shape->kept_apart(i) + margins[i] <= 0});
  return out;
}

std::vector<std::string> words_on_home(const Rig& rig) {
  std::vector<std::string> out;
  for (const TooClose& parts : parts_too_close_at_home(rig))
    out.push_back("at home " + parts.what + ": the gate would let them only part");
  return out;
}

}  // namespace foresight
