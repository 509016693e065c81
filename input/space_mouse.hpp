// A 6-DOF device (a space mouse) by spacenavd, the daemon that drives them.
//
//   the cap  pushed and turned: the hand, likewise      button 1  the deadman switch and the clutch
//   button 2  closes the gripper; the next time, opens it    button 3  the view as it began    button 4  recentre
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "input/rate_hand.hpp"

namespace foresight {

struct SpaceMouseOptions {
  RateHandOptions hand;
  double full_scale = 350;  ///< of an axis, as spacenavd says it of a cap at its end
  double dead_zone = 0.05;
  /// A deflection that was not said again for longer counts as none.
  Duration stale_after = std::chrono::milliseconds(500);
  Duration try_again = std::chrono::seconds(2);
};

/// libspnav has one connection for the whole process: one at a time, one thread. Opening waits 0.3 s for a daemon that
/// does not answer; a daemon that has gone is looked for again each `try_again`.
class SpaceMouse final : public Tracker {
 public:
  /// The daemon may come later. Its socket is that of SPNAV_SOCKET, ~/.spnavrc, or /run/spnav.sock.
  explicit SpaceMouse(const SpaceMouseOptions& options = {});
  ~SpaceMouse() override;
  SpaceMouse(const SpaceMouse&) = delete;
  SpaceMouse& operator=(const SpaceMouse&) = delete;

  /// Each button, and what it does.
  static std::vector<std::pair<std::string, std::string>> keys();
  std::string name() const override { return "6-DOF device (spacenavd)"; }
  TrackerState read(OperatorTime now) noexcept override;

 private:
  void look_for_daemon(OperatorTime now) noexcept;
  void take_events(OperatorTime now) noexcept;
  void plugged(bool there) noexcept;
  void button(int number, bool down) noexcept;

  SpaceMouseOptions options_;
  RateHand hand_;
  bool open_ = false, unplugged_ = false;
  std::optional<OperatorTime> tried_, moved_;
  HandRate rate_;
  TrackerButtons buttons_;
  bool closes_next_ = true;
};

}  // namespace foresight
