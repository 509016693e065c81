// A model of a person: where it sees things late, it moves and waits, and still gets there.
#include "seat/model_operator.hpp"

#include <gtest/gtest.h>

#include <deque>
#include <numbers>

namespace foresight::model_operator_test {
namespace {

Pose at(double x, double y, double z) {
  Pose out = Pose::Identity();
  out.translation() = Eigen::Vector3d(x, y, z);
  return out;
}

Pose pointing_down(double x, double y, double z) {
  return at(x, y, z) * Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
}

/// A hand that is where it is told at once, and takes the thing along while its jaws are closed about it.
class World {
 public:
  explicit World(double late) : late_(late) {}

  void follow(double t, const OperatorHand& hand) {
    const bool closed = hand.opening < 0.022, was_closed = now_.opening < 0.022;
    const Eigen::Vector3d grip = hand.T_world_tool.translation() - Eigen::Vector3d(0, 0, 0.037);
    if (closed && !was_closed) held_ = (grip - now_.T_world_thing.translation()).norm() < 0.015;
    if (!closed) held_ = false;
    if (held_ && drops && now_.T_world_thing.translation().z() > 0.1) {
      held_ = drops = false;
      now_.T_world_thing.translation().z() = 0;
    }
    if (held_) now_.T_world_thing.translation() += grip - grip_;
    if (!closed) now_.T_world_thing.translation().z() = 0;
    grip_ = grip;
    if (!stuck(hand)) now_.T_world_tool = hand.T_world_tool;
    now_.opening = hand.opening;
    past_.push_back({t, now_});
    while (past_.size() > 1 && past_[1].first <= t - late_) past_.pop_front();
  }
  const OperatorSees& seen() const { return past_.front().second; }
  double ahead() const { return ahead_; }  ///< m: the farthest that the hand was from the tool
  bool in_tray() const {
    return (now_.T_world_thing.translation() - now_.T_world_tray.translation()).head<2>().norm() < 0.07;
  }
  bool drops = false;   ///< once, when it has been lifted
  bool sticks = false;  ///< once, on the way down: the tool stays for half a minute, whatever the hand does

 private:
  bool stuck(const OperatorHand& hand) {
    if (sticks && now_.T_world_tool.translation().z() < 0.15) sticks = false, stuck_cycles_ = 3000;
    ahead_ = std::max(ahead_, (hand.T_world_tool.translation() - now_.T_world_tool.translation()).norm());
    return stuck_cycles_ > 0 && stuck_cycles_-- > 0;
  }

  double late_;
  OperatorSees now_{pointing_down(0, 0, 0.25), 0.038, at(0.1, 0.05, 0), at(-0.1, 0.1, 0)};
  Eigen::Vector3d grip_ = Eigen::Vector3d::Zero();
  bool held_ = false;
  int stuck_cycles_ = 0;
  double ahead_ = 0;
  std::deque<std::pair<double, OperatorSees>> past_;
};

struct Trial {
  double seconds = 0;
  bool in_tray = false;
  int moves = 0, regrasps = 0;
};

Trial try_it(World& world, unsigned seed) {
  ModelOperatorOptions options;
  options.seed = seed;
  ModelOperator person(options, {pointing_down(0, 0, 0.25), 0.038});
  double t = 0;
  for (; t < 300 && !person.done(); t += 0.01) {
    world.follow(t, person.hand(t));
    person.see(t, world.seen());
  }
  return {t, world.in_tray(), person.moves(), person.regrasps()};
}

Trial try_it(double late, unsigned seed, bool drops = false) {
  World world(late);
  world.drops = drops;
  return try_it(world, seed);
}

// Ferrell: the time grows with the delay, by as much for each move that is waited for; the moves stay as many.
TEST(ModelOperator, MovesAndWaitsWhereItSeesLate) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const Trial at_once = try_it(0, seed), late = try_it(1, seed), later = try_it(2, seed);
    EXPECT_TRUE(at_once.in_tray && late.in_tray && later.in_tray) << seed;
    EXPECT_LT(at_once.seconds, 30) << seed;
    EXPECT_GT(late.seconds, at_once.seconds + 7) << seed;
    EXPECT_GT(later.seconds, late.seconds + 7) << seed;
    EXPECT_LT(later.moves, 2 * at_once.moves) << "it waits, and does not chase what it sees; seed " << seed;
  }
}

TEST(ModelOperator, TakesAThingAgainThatFell) {
  for (const double late : {0.0, 1.0}) {
    const Trial fell = try_it(late, 5, true);
    EXPECT_TRUE(fell.in_tray);
    EXPECT_EQ(fell.regrasps, 1);
    EXPECT_GT(fell.seconds, try_it(late, 5).seconds + 3);
  }
}

// A hand that asks ever farther because nothing comes of it would never find back.
TEST(ModelOperator, BringsAHandBackThatTheToolDidNotFollow) {
  for (const double late : {0.0, 1.0}) {
    World world(late);
    world.sticks = true;
    const Trial stuck = try_it(world, 3);
    EXPECT_TRUE(stuck.in_tray) << late;
    EXPECT_GT(stuck.seconds, 30) << late;
    EXPECT_LT(world.ahead(), 0.2) << "one move, however often it is tried; " << late;
  }
}

TEST(ModelOperator, IsTheSameForTheSameSeed) {
  EXPECT_EQ(try_it(0.5, 9).seconds, try_it(0.5, 9).seconds);
  EXPECT_NE(try_it(0.5, 9).seconds, try_it(0.5, 10).seconds);
}

}  // namespace
}  // namespace foresight::model_operator_test
