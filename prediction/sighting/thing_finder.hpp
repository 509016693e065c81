// Where the pictures of one instant show the things: what sets ThingFuture right.
//
//   a tag in the picture ----------------------------------> corners of both cameras, one pose
//   no tag: its colours, or edges before these are known,
//           around where it should be,
//           or in the hand that lost it -----fit agrees--> sighting
//                        | not
//                        '--> about where it was last at rest, and below the hand --fit agrees--> sighting
//                        | not, and what is seen there is something else
//                        '--> missing
//
// The colours of its surface are what earlier pictures showed of it: two bricks of one shape are told apart once both
// were seen. Nothing is claimed of a thing that is too small, too covered or out of the picture.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "prediction/grasp/thing_future.hpp"
#include "prediction/sighting/surface_colours.hpp"
#include "prediction/sighting/tag_fit.hpp"
#include "prediction/sighting/thing_search.hpp"
#include "scene/posed_frame.hpp"
#include "scene/stereo_lenses.hpp"

namespace foresight {

struct SoughtThing {
  std::size_t node = 0;  ///< of the model
  std::optional<ThingTag> tag = {};
};

/// As it was thought to be at the picture's instant.
struct ExpectedThing {
  Pose T_world_thing = Pose::Identity();
  bool held = false;                 ///< in the hand
  bool moving = false;               ///< nothing to compare with: not looked for
  std::optional<Pose> in_hand = {};  ///< where it is if it has not slipped from the hand after all
};

struct ThingFinderOptions {
  double least_agreement = 0.6;  ///< EdgeFit::agreement
  double most_sigma = 0.006;     ///< m
  double most_difference = 8;    ///< grey levels: ColourFit::difference, where it should be
  /// Of one that rests, and fits to within so much (m) of where it should be: that is no chance, but other light on it,
  /// as in a tray.
  double in_place = 0.005, most_difference_in_place = 12;
  double found_difference = 4.5;              ///< of one that is sought: of many poses one may look alike by chance
  double farthest = 0.03;                     ///< m that one fit may move it by
  double search_reach = 0.06;                 ///< m
  double floor_m = 0.0008, floor_rad = 0.01;  ///< what every pose is off by, beside its own sigma
};

struct FoundThings {
  std::vector<ThingSighting> sightings;  ///< ThingSighting::thing: index of the sought thing
  std::vector<std::size_t> missing;      ///< looked where it should have been, with nothing in between: not there
};

/// One thread.
class ThingFinder {
 public:
  /// Throws InputError: two things with one tag.
  ThingFinder(std::shared_ptr<const SceneModel> model, std::vector<SoughtThing> things, const StereoLenses& lenses,
              const ThingFinderOptions& options = {});

  /// `frame`: pictures of the lenses' sizes (else nothing is found), with all nodes where they were thought to be;
  /// `expected`: of each thing.
  FoundThings look(const PosedFrame& frame, std::span<const ExpectedThing> expected);

 private:
  struct Thing {
    std::size_t node = 0;
    std::optional<ThingTag> tag;
    ThingShape shape;
    SurfaceColours colours;
    std::optional<Pose> rested;  // where it was last seen, not in the hand
  };
  struct Looked;  // one frame's pictures
  struct Fit {
    Pose T_world_thing;
    Matrix6d covariance;
    double worth = 0;  // to compare two of one thing
    bool in_hand = false;
  };

  std::optional<Fit> agreeing(const Thing& thing, const Looked& looked, const Pose& start, bool held) const;
  std::optional<Fit> search(const Thing& thing, const Looked& looked, const ExpectedThing& expected) const;
  bool taken_by_another(const Thing& thing, const Pose& T, const FoundThings& found) const;
  bool is_missing(const Thing& thing, const Looked& looked, const Pose& expected) const;
  ThingSighting sighting(std::size_t thing, RobotTime captured, const Pose& T, const Matrix6d& covariance) const;
  void find_tags(const PosedFrame& frame, std::vector<bool>& done, FoundThings& out);

  std::shared_ptr<const SceneModel> model_;
  StereoLenses lenses_;
  ThingFinderOptions options_;
  std::vector<Thing> things_;
  CoarseRays rays_[2];
  std::unique_ptr<TagDetector> tags_;  // where something has one
  std::size_t next_search_ = 0;
};

}  // namespace foresight
