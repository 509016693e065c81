#include "seat/seat_options.hpp"

#include "link/control/motion_permit.hpp"

namespace foresight {

link::OperatorEndOptions seat_end_options(const Rig& rig, Identity identity, const LiveScene& scene) {
  link::OperatorEndOptions out;
  out.seat.identity = std::move(identity);
  out.seat.place = rig.link.place();
  out.seat.draw = machine_nonces();
  out.seat.oldest_state = std::max(out.seat.oldest_state, rig.link.round_trip);
  out.seat.answered_within = std::max(out.seat.answered_within, 2 * rig.link.round_trip);
  out.expected.joints = rig.joint_names();
  if (const auto& lenses = scene.lenses()) {
    const auto size = [](int pixels) { return static_cast<std::uint32_t>(pixels); };
    out.expected.image_sizes = {size(lenses->left.width()), size(lenses->left.height()), size(lenses->right.width()),
                                size(lenses->right.height())};
  }
  return out;
}

}  // namespace foresight
