// A person at the seat, as a model: moves, waits for what the move has brought about to be seen, corrects.
//
//   perceive, decide --> move, unseen --> wait until what is seen has come to rest --> perceive, decide ...
//
// Ferrell found that people do so by themselves once what they see is late ("Remote manipulation with transmission
// delay", IEEE Transactions on Human Factors in Electronics 6, 1965). The rest is the iterative corrections model of
// aimed movements: what is left of a way after one unseen move is in proportion to it (Crossman and Goodeve, Quarterly
// Journal of Experimental Psychology 35A, 1983; Keele, Psychological Bulletin 70, 1968), and a decision takes one cycle
// of Card, Moran and Newell's model processor ("The Psychology of Human-Computer Interaction", 1983).
//
// It is a model and no person: it neither tires nor learns, and it knows its task.
#pragma once

#include <optional>
#include <random>

#include "scene/scene_model.hpp"

namespace foresight {

/// All that is seen, of one instant: of the newest image, or of a prediction. World frame, m, rad.
struct OperatorSees {
  Pose T_world_tool = Pose::Identity();  ///< between the finger tips, z out of the hand
  double opening = 0;                    ///< of the jaws' joint
  Pose T_world_thing = Pose::Identity(), T_world_tray = Pose::Identity();
};

struct OperatorHand {
  Pose T_world_tool = Pose::Identity();
  double opening = 0;
};

struct ModelOperatorOptions {
  unsigned seed = 1;
  double decision = 0.24;      ///< s: perceptual, cognitive and motor step of the model processor (100 + 70 + 70 ms)
  double left_of_move = 0.07;  ///< root mean square of what is left of a way after an unseen move, as a share of it
  /// One sigma along each axis, about the vertical: a seventh of a pixel of disparity 0.7 m before cameras of 525 px
  /// focal length, 65 mm apart.
  double sight = 0.002, sight_rad = 0.02;
  double speed = 0.25, turning = 0.8;   ///< m/s, rad/s, means of a move
  double shortest_move = 0.3;           ///< s
  double rests_for = 0.2;               ///< s for which what is seen has to be at rest
  double grasp_height = 0.037;          ///< m: finger tips above the thing's bottom
  double above = 0.14;                  ///< m: higher, where it moves to and fro
  double open = 0.038, closed = 0.016;  ///< of the jaws' joint
};

/// Takes a thing from where it stands, and sets it down in a tray. One thread; the same sights give the same hand.
class ModelOperator {
 public:
  /// The hand is at `hand` at `t` = 0, the tool's z pointing down.
  ModelOperator(const ModelOperatorOptions& options, const OperatorHand& hand);

  /// What is seen `t` seconds after the begin, which never goes back; often, at least ten times a second.
  void see(double t, const OperatorSees& sees);
  /// Where the hand is at `t`.
  OperatorHand hand(double t) const;

  /// It sees the thing in the tray, and has left it.
  bool done() const { return aim_ == Aim::done; }
  int moves() const { return moves_; }        ///< of the hand, jaws not counted
  int regrasps() const { return regrasps_; }  ///< times that it saw the thing elsewhere than in the hand or the tray

 private:
  enum class Aim : std::uint8_t { above, down, close, lift, carry, lower, open, leave, judge, rise, done };
  struct Way {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    double turn = 0;
    bool good = false;  // near enough
  };
  bool waits(double t, const OperatorSees& sees);
  void watch(double t, const OperatorSees& sees);
  void decide(double t, const OperatorSees& sees);
  bool pursue(double t, const OperatorSees& seen);
  OperatorSees glance(const OperatorSees& sees);
  Way way_to(const OperatorSees& seen) const;
  bool holds(const OperatorSees& seen) const;
  OperatorHand at_tool(double t, const OperatorSees& seen) const;
  void go(double t, const Way& way, const OperatorSees& seen);
  void use_jaws(double t, double opening, Aim next);
  void lost(double t, const OperatorSees& seen);
  double normal(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }

  ModelOperatorOptions options_;
  std::mt19937_64 random_;
  Aim aim_ = Aim::above;
  // The move that is under way, or the last.
  OperatorHand from_, to_;
  double begun_ = 0, ends_ = 0;
  bool wide_ = false;  // enough to be seen
  // What was seen.
  OperatorSees at_begin_, still_;
  bool any_seen_ = false, began_seen_ = false;
  double still_since_ = 0, lag_ = 0;
  std::optional<double> decides_at_;
  int moves_ = 0, regrasps_ = 0;
};

}  // namespace foresight
