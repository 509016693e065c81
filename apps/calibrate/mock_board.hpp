// A board in the mock lab, shown to its two cameras as a careful person shows one.
//
//   station   0        1        2              still for 0.7 s, which is when a view is taken, then on
//             ----\____----\____----\___  t    to the next within 0.3 s
//            -0.1 0.6
#pragma once

#include <vector>

#include "apps/calibrate/capture_source.hpp"
#include "calibration/target/board.hpp"
#include "sim/print.hpp"

namespace foresight {

/// Every part of the image, near and far, tilts of up to 45 degrees to all sides; always the whole board in both
/// images. The same arguments give the same stations. Immutable; any thread.
class MockBoard {
 public:
  static constexpr double kStation = 1;          ///< seconds
  static constexpr double kRate = 2 / kStation;  ///< images per second that are enough: each station stands in two
  static constexpr int kStations = 36;           ///< then from the first one again

  /// `cameras`: lenses and place of the right one. Throws InputError: a board that both cameras cannot see whole at
  /// any distance, or only from so far that the lab has no room; what board_picture() throws.
  MockBoard(const Board& board, const StereoLenses& cameras, unsigned seed);

  /// For MockWorld.
  sim::MovingPrint print() const;
  /// At time `t` since the world's start, the head standing as shafts() has it.
  Pose T_world_board(double t) const;
  const std::vector<Pose>& stations() const { return T_left_board_; }  ///< board frame: calibration/target/board.hpp

  /// The head looks past the arm at the free wall; arm and gripper rest.
  static std::optional<double> shafts(std::string_view joint);

 private:
  std::vector<Pose> T_left_board_;
  Pose T_board_print_ = Pose::Identity();
  sim::Print print_;
};

/// Both mock cameras of `config` with such a board before them; in stepped time where `clock` is a SteppedClock. Blocks
/// some seconds: the lab is lit. Throws what MockBoard and open_stereo() throw.
std::unique_ptr<CaptureSource> mock_board_source(const StereoConfig& config, const Board& board, unsigned seed,
                                                 Clock& clock);

}  // namespace foresight
