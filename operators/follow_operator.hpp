// Follows a file, from enabling to rest.
#pragma once

#include <string>
#include <vector>

#include "operators/commander.hpp"
#include "operators/follow_file.hpp"
#include "operators/robot_start.hpp"

namespace foresight {

/// Enables, homes where it may and must, goes to where the file begins, follows it, and ends. It is done only where the
/// robot came to where the file ends, and nothing held it back on the way: a motion that the safety gate held, slowed
/// down in a corner, or let go of in the middle ends as "not reached" or "not followed", with the joint, where it
/// stands, where it should be, since when, and what held it.
class FollowOperator final : public Commander {
 public:
  static constexpr std::uint64_t kId = 1;

  FollowOperator(FollowFile file, bool may_home);
  std::uint64_t operator_id() const override { return kId; }
  const FollowFile& file() const { return file_; }
  OperatorWish tick(RobotTime now, const RobotStatus& status) override;
  /// "done", or why not; empty while it goes on.
  const std::string& outcome() const { return outcome_; }
  bool succeeded() const { return outcome_ == "done"; }

 private:
  enum class Step { start, release, approach, follow, rest };
  OperatorWish command(RobotTime now, bool deadman);
  OperatorWish end(std::string outcome);
  OperatorWish approach(RobotTime now, const RobotStatus& status);
  OperatorWish follow(RobotTime now, const RobotStatus& status);
  void enter(Step step, RobotTime now);
  void watch(RobotTime now, const RobotStatus& status);
  std::size_t farthest(const RobotStatus& status) const;
  double gap(const RobotStatus& status) const;
  std::string place(std::size_t joint, const RobotStatus& status) const;
  std::string stopped_text(const RobotStatus& status) const;
  std::string result(bool reached, const RobotStatus& status) const;

  FollowFile file_;
  std::size_t joints_;
  RobotStart start_;
  Step step_ = Step::start;
  bool engaged_ = false;
  RobotTime since_, moved_;
  CommandCounter counter_{kId};
  JointValues target_{};
  /// What held the robot back while it followed.
  struct Held {
    double since_s = 0;  // of the file
    GateHold worst;      // when the joint was farthest from where it should have been
  };
  std::optional<Held> held_;
  std::string result_ = "done";  // once at rest
  std::string outcome_;
};

}  // namespace foresight
