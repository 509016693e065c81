// A model operator (seat/model_operator.hpp) at a robot beyond a line, who sees the newest image's instant or the
// predicted one, and puts a brick into a tray of the physical lab. A simulation, and no more than that.
//
//   ModelOperator --hand--> joints --line--> gate, emulated drives --shafts--> physical lab: where things truly are
//        ^                                                                        | 10 images a second, the line
//        '--- sees: the newest image's instant, or the robot and things predicted from these and what was sent
#pragma once

#include <vector>

#include "rig/rig.hpp"

namespace foresight {

/// What happens to the brick that nothing foretells.
enum class OperatorAccident : std::uint8_t {
  none,
  slips,  ///< out of the hand, once, as it is carried
  moved,  ///< by 6 cm, once, as the hand comes down on it
};

struct OperatorTrialOptions {
  bool predicted = false;  ///< sees the prediction; else the newest image
  double delay = 0.5;      ///< s, each way
  OperatorAccident accident = OperatorAccident::none;
  int runs = 10;
  unsigned seed = 1;      ///< of the operator's noise, of places, masses and friction, from run to run
  double gives_up = 180;  ///< s, after which a run has failed
};

struct OperatorRun {
  bool succeeded = false;  ///< the brick is in the tray, in truth, and the operator has left it
  double seconds = 0;
  int moves = 0, regrasps = 0;
};

/// One run after the other. `rig`: that of the mock lab's arm. Throws InputError where it is another's, as try_robot().
std::vector<OperatorRun> try_operator(const Rig& rig, const OperatorTrialOptions& options);

}  // namespace foresight
