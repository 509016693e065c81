// A motion in a CSV file: times, and where the joints are then.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "rig/rig.hpp"

namespace foresight {

struct TextRow;

/// Positions over time, straight between the rows. Immutable.
class FollowFile {
 public:
  /// First line: `time_s` and names of joints of the rig, in any order; joints that are not named stay where they are.
  /// Then rows of as many numbers, times ascending. Throws InputError naming file and line: an unknown joint, a number
  /// that is none, one beyond the joint's limits, times that do not ascend, or a motion faster than a joint may move.
  FollowFile(const std::filesystem::path& file, const Rig& rig);

  double duration_s() const { return times_.back() - times_.front(); }
  /// Of what its joint may do, the fastest motion: 0, where nothing moves, to 1.
  double fastest() const { return fastest_; }
  /// `seconds` after the first row; before and after, where it begins and ends. Joints that are not named keep
  /// their value in `positions`.
  void at(double seconds, JointValues& positions) const;
  /// All joints of the rig, in its order.
  const std::vector<JointWords>& joints() const { return words_; }

 private:
  void add(const TextRow& row, const Rig& rig);

  std::vector<JointWords> words_;
  std::vector<std::size_t> joints_;  // of each column, its joint
  std::vector<double> times_;
  std::vector<std::vector<double>> rows_;
  double fastest_ = 0;
};

/// How long it takes, for whoever starts it; and that it is so slow that its times may be in another unit.
std::vector<std::string> words_on_start(const FollowFile& file);

}  // namespace foresight
