// Where the display shows things, for a program that operates by what it sees.
#pragma once

#include <mutex>
#include <optional>
#include <string>

#include "scene/scene_model.hpp"

namespace foresight {

/// Any thread.
class SeenNodes {
 public:
  explicit SeenNodes(std::shared_ptr<const SceneModel> model) : model_(std::move(model)) {}

  /// This is what is shown from now on.
  void show(const SceneState& state) {
    const std::lock_guard lock(mutex_);
    T_world_node_ = state.T_world_node;
  }
  /// Nothing: nothing is shown yet, or nothing of that name.
  std::optional<Pose> at(const std::string& node) const {
    const auto index = model_->find(node);
    const std::lock_guard lock(mutex_);
    if (!index || static_cast<std::size_t>(*index) >= T_world_node_.size()) return std::nullopt;
    return T_world_node_[static_cast<std::size_t>(*index)];
  }

 private:
  std::shared_ptr<const SceneModel> model_;
  mutable std::mutex mutex_;
  std::vector<Pose> T_world_node_;
};

}  // namespace foresight
