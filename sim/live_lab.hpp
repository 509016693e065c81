// The lab as a live world: its arm and head stand where drives' shafts stand, and a ball rolls on the table.
//
// Truth and model are two things: hidden deviations make the world differ from what the robot believes.
#pragma once

#include <functional>
#include <optional>
#include <string_view>

#include "sim/arm.hpp"
#include "sim/lab.hpp"
#include "sim/pan_tilt_head.hpp"
#include "sim/print.hpp"

namespace foresight::sim {

/// Position of a joint's shaft by name (those of sim/arm.hpp without the mimic, "pan", "tilt"); rad or m. Nothing for
/// one that the world should leave at rest.
using ShaftPositions = std::function<std::optional<double>(std::string_view joint)>;
/// The same at an instant, for the present and shortly before.
using ShaftsAt = std::function<std::optional<double>(std::string_view joint, RobotTime)>;

/// What the model does not know. Each value is drawn evenly from -size .. size, but for the object's way, which has
/// exactly that length.
struct HiddenDeviations {
  unsigned seed = 1;
  double object_m = 0;    ///< one thing on the table stands this far from where the model has it; 0 .. 0.05
  double object_rad = 0;  ///< and is turned by up to this about z
  double joint_rad = 0;   ///< of each turning joint of the lab's own arm, and of pan and tilt
};

inline constexpr const char* kBall = "ball";

/// Immutable; safe to share between threads (`shafts` is called on the caller's). The same arguments give the same
/// world, so in stepped time all is repeatable.
class LiveLab {
 public:
  struct Options {
    double texel = 0.001;  ///< metres, of the finest pictures
    unsigned seed = 1;     ///< of grain and small print
    HiddenDeviations hidden = {};
    std::vector<Print> prints = {};  ///< that stand still
    std::optional<MovingPrint> board = {};
    /// In place of the lab's own arm: the rig's robot, or a whole scene with it. Null: the lab's own arm.
    std::shared_ptr<const RobotScene> things = {};
    bool furniture = true;              ///< with `things`: the lab's own around them, and the ball
    std::optional<unsigned> task = {};  ///< bricks and a tray on the table: task_layout() (sim/lab_task.hpp)
    /// Parts that may be anywhere, as in a physical lab (sim/physics): true_state() leaves them at rest, the ball too.
    /// Names that the lab does not have are left out.
    std::vector<std::string> loose = {};
  };
  /// Throws InputError (a deviation out of range; what check() says of a print; a part that the lab does not have; a
  /// thing that has the name of a part of the lab).
  explicit LiveLab(const Options& options);

  /// The true lab: a displaced object stands where it truly is.
  const Lab& lab() const { return lab_; }
  /// What the robot believes of the parts: rest poses of the model, one per part.
  const LabState& modelled_rest() const { return modelled_rest_; }
  /// The same as a scene. What shafts move may move; of what is loose and of the ball, nothing tells where they are.
  SceneModel modelled_scene() const;
  /// Those that stand still, then the board where there is one. No parts of lab(): they are painted on what stands.
  const std::vector<Print>& prints() const { return prints_; }
  bool is_loose(std::size_t part) const { return loose_[part]; }
  int displaced() const { return displaced_; }  ///< part that is not where the model has it; -1: none

  /// Where every part truly stands `t` seconds after the start. The arm and the ball know nothing of each other.
  LabState true_state(const ShaftPositions& shafts, double t) const;
  /// The same as the encoders tell it: without hidden offsets, the displaced object and the ball at rest.
  LabState modelled_state(const ShaftPositions& shafts) const;

  /// Where every one of prints() is; `T_world_part`: true_state(shafts, t).
  std::vector<Pose> true_prints(const LabState& T_world_part, double t) const;

  Pose T_world_left(const ShaftPositions& shafts) const;            ///< true
  static Pose T_world_left_modelled(const ShaftPositions& shafts);  ///< by the encoders

  /// Where the ball is: rolls to and fro without slip, along y.
  static Pose T_world_ball(double t);

 private:
  void add_prints(const Options& options);
  LabState with_robot(LabState state, const ShaftPositions& shafts, const std::array<double, 7>& offsets) const;

  Lab lab_;
  LabState modelled_rest_;
  std::vector<bool> loose_;  // of each part
  std::shared_ptr<const RobotScene> things_;
  std::array<double, 7> joint_offsets_{};
  PanTilt head_offset_;
  std::vector<Print> prints_;
  std::function<Pose(double)> T_board_;  // in the world, or in board_part_
  int board_part_ = -1;
  int displaced_ = -1;
  int ball_ = -1;  // part; -1: none
};

/// The arm a little bent above the table, the head at the table: for worlds without drives.
std::optional<double> shafts_at_rest(std::string_view joint);

}  // namespace foresight::sim
