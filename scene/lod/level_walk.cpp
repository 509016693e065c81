#include "scene/lod/level_walk.hpp"

#include <algorithm>
#include <cmath>

namespace foresight {

LevelWalk::LevelWalk(std::size_t nodes, LevelTransition transition, double seconds)
    : transition_(transition), seconds_(seconds), nodes_(nodes) {}

void LevelWalk::aim(int node, int level) {
  Node& n = at(node);
  const bool known = is_known(node);
  n.unseen = 0;
  if (known && n.goal == level) return;
  n.goal = level;
  if (!known || transition_ == LevelTransition::hard || !(seconds_ > 0)) n.place = level;
  n.speed = std::max(1.0, std::abs(n.place - level)) / seconds_;
}

void LevelWalk::step(double seconds) {
  const bool all = !(seconds > 0);
  for (Node& n : nodes_) {
    n.unseen = std::min(n.unseen + 1, 2);
    const double way = n.goal - n.place, reach = n.speed * seconds;
    n.place = all || !(std::abs(way) > reach) ? n.goal : n.place + std::copysign(reach, way);
  }
}

void LevelWalk::arrive(int node) {
  at(node).place = at(node).goal;
}

LevelBlend LevelWalk::blend(int node) const {
  const double place = nodes_[static_cast<std::size_t>(node)].place, level = std::floor(place);
  return {static_cast<int>(level), static_cast<float>(place - level)};
}

bool LevelWalk::is_known(int node) const {
  return nodes_[static_cast<std::size_t>(node)].unseen < 2;
}

bool LevelWalk::is_on_the_way(int node) const {
  const Node& n = nodes_[static_cast<std::size_t>(node)];
  return n.place != n.goal;
}

}  // namespace foresight
