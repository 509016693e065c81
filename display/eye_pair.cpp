#include "display/eye_pair.hpp"

namespace foresight {

EyePair::EyePair(ViewSession& session, const std::array<Lens, 2>& lenses, double separation)
    : session_(session), separation_(separation) {
  for (const Lens& lens : lenses) eyes_.push_back(session.make_view(lens));
}

void EyePair::set_lenses(const std::array<Lens, 2>& lenses) {
  for (std::size_t eye = 0; eye < eyes_.size(); ++eye) eyes_[eye].set_lens(lenses[eye]);
}

bool EyePair::draw(const Pose& T_world_camera, const SceneState& state) {
  bool drawn = true;
  for (std::size_t eye = 0; eye < eyes_.size(); ++eye)
    drawn = session_.draw(eyes_[eye], T_world_camera * T_view_eye(eye), state) && drawn;
  return drawn;
}

}  // namespace foresight
