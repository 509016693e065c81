// Where the main lamp is, and how strong: from the shadows of what moves.
//
// A point of the scene that stands still is darker in an image than it usually is. If the reason is the shadow of a
// moving part, the lamp lies behind that part, seen from the point. Each position of a lamp foretells which points are
// dark in which image; the one that explains most of what was seen is it. One lamp above all others is assumed, and
// light from all around; what it does not explain (highlights, other lamps, errors) speaks against it.
#pragma once

#include <deque>
#include <future>
#include <memory>
#include <span>

#include "scene/scene_model.hpp"
#include "texture_gpu/lamp/lamp_search.hpp"
#include "texture_gpu/lamp/lamp_watch.hpp"

namespace foresight {

/// One thread; searches in another one, whose answers count some images later.
class LampFinder {
 public:
  /// `awaits`: always as many images later, so that the same images give the same lamp; else so many at least.
  explicit LampFinder(std::shared_ptr<const SceneModel> scene, bool awaits = true);

  /// Before each image: where everything stands there. True where the image may tell something new: then add() is to be
  /// called with it.
  bool look(const SceneState& state);

  /// The points whose brightness is asked for. They change in look() alone, and with number().
  std::span<const Witness> witnesses() const { return witnesses_; }
  int number() const { return number_; }

  /// `brightness`: red, green and blue of each witness in the image that look() was told of, the exposure evened out
  /// or not; negative where it was not seen, or white. `camera`: its place, world.
  void add(const SceneState& state, const Eigen::Vector3d& camera, std::span<const Eigen::Vector3f> brightness);

  /// Nothing as long as it cannot be told.
  const std::optional<Lamp>& lamp() const { return answer_.lamp; }
  /// One for each node: it may move or has moved, and throws shadows that move.
  const std::vector<bool>& moving() const { return moving_; }

  /// Until no search is under way, for those who measure; its answer counts no sooner than else.
  void wait_for_search() const;

  /// What the last search found.
  const LampAnswer& answer() const { return answer_; }

 private:
  void choose();
  void ask();
  void watch();

  std::shared_ptr<const SceneModel> scene_;
  const bool awaits_;
  ShadowRays rays_;
  std::vector<Pose> first_, last_;  // T_world_node: of the first image, of the last record
  std::vector<bool> moving_;
  std::vector<Witness> witnesses_;
  std::vector<bool> turned_;  // the witness's normal shows to the cameras
  std::deque<LampRecord> records_;
  LampWatch watch_;  // of answer_.lamp
  int number_ = 0;
  int recorded_ = 0, ask_at_ = 0, look_around_at_ = 0;  // counts of records
  int looked_at_ = 0, answer_at_ = 0;                   // counts of images
  std::future<LampAnswer> search_;
  LampAnswer answer_;
};

}  // namespace foresight
