#include "display/head/head_hands.hpp"

namespace foresight::head {

void HeldController::say(const TrackerState& state) noexcept {
  const std::lock_guard lock(mutex_);
  state_ = state;
}

TrackerState HeldController::heard() const noexcept {
  const std::lock_guard lock(mutex_);
  return state_;
}

HeldControllers::HeldControllers() {
  gone("the headset shows nothing yet", "put it on");
}

void HeldControllers::gone(const char* trouble, const char* cure) noexcept {
  for (HeldController& hand : hands) {
    TrackerState state;
    state.time = hand.heard().time;
    state.trouble = trouble;
    state.cure = cure;
    hand.say(state);
  }
}

HeadHands::HeadHands(std::shared_ptr<const HeldControllers> held)
    : held_(std::move(held)),
      hands_{One(held_->hands[0], "left controller"), One(held_->hands[1], "right controller")},
      any_({&hands_[0], &hands_[1]}) {}

}  // namespace foresight::head
