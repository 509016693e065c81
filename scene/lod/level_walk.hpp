// How a node goes from one level to another, so that nobody sees it jump.
//
//   place  0         1   level 1 and no other     1.3 is on the way from level 1 to 2:  geomorph: level 1, its vertices
//   0.3 of
//                                                                                       the way; fade: both, in 7 of 10
//                                                                                       and in 3 of 10 pixels
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace foresight {

enum class LevelTransition : std::uint8_t {
  hard,      ///< at once
  geomorph,  ///< vertices move to where the other level's surface is
  fade       ///< one level's pixels give way to the other's, in a screen-door pattern
};

/// What a node is drawn with.
struct LevelBlend {
  int level = 0;    ///< the finer one
  float share = 0;  ///< of the way to the next coarser one, in [0, 1)
};

/// The ways of all nodes of a scene. One thread.
class LevelWalk {
 public:
  /// A way takes so many seconds, however many levels it is; nothing is drawn on the way with hard transitions.
  LevelWalk(std::size_t nodes, LevelTransition transition, double seconds);

  /// Where a node is to go; one that has not been seen in the last step is there at once.
  void aim(int node, int level);
  /// Time has gone on by `seconds`; 0 or less, or no number: all arrive.
  void step(double seconds);
  /// A node arrives now: its time is needed for others.
  void arrive(int node);

  LevelBlend blend(int node) const;
  /// It was aimed in the last step or since.
  bool is_known(int node) const;
  int goal(int node) const { return nodes_[static_cast<std::size_t>(node)].goal; }
  bool is_on_the_way(int node) const;

 private:
  struct Node {
    double place = 0, speed = 0;  // levels, levels/s
    int goal = 0;
    int unseen = 2;  // steps without aim()
  };
  Node& at(int node) { return nodes_[static_cast<std::size_t>(node)]; }

  LevelTransition transition_;
  double seconds_;
  std::vector<Node> nodes_;
};

}  // namespace foresight
