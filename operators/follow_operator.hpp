// Follows a file, from enabling to rest.
#pragma once

#include <string>
#include <vector>

#include "operators/commander.hpp"
#include "operators/follow_file.hpp"

namespace foresight {

/// Enables, homes where it may and must, goes to where the file begins, follows it, and ends.
class FollowOperator final : public Commander {
 public:
  static constexpr std::uint64_t kId = 1;

  /// `joints`: the rig's, by name.
  FollowOperator(FollowFile file, std::vector<std::string> joints, bool may_home);
  std::uint64_t operator_id() const override { return kId; }
  OperatorWish tick(RobotTime now, const RobotStatus& status) override;
  /// "done", or why not; empty while it goes on.
  const std::string& outcome() const { return outcome_; }
  bool succeeded() const { return outcome_ == "done"; }

 private:
  enum class Step { enable, home, release, approach, follow, rest };
  OperatorWish command(RobotTime now, bool deadman);
  OperatorWish end(std::string outcome);
  void enter(Step step, RobotTime now);

  FollowFile file_;
  std::vector<std::string> names_;
  std::size_t joints_;
  bool may_home_;
  Step step_ = Step::enable;
  bool asked_ = false, engaged_ = false;
  RobotTime since_;
  CommandCounter counter_{kId};
  JointValues target_{};
  std::string outcome_;
};

}  // namespace foresight
