// `foresight bench prediction contact`: what touches and what is near, of a robot in the lab, beside FCL and Bullet.
#pragma once

#include <filesystem>
#include <optional>

namespace foresight {

struct PredictionContactOptions {
  std::optional<std::filesystem::path> urdf;  ///< else the lab's own arm
  int triangles = 2000;  ///< of each link and of what is carried: split or simplified; 0: as they are
  int poses = 2000;
  int peer_poses = 20;  ///< how many of them, the first ones, Bullet gets for distances; ten times: FCL
  std::optional<std::filesystem::path> json;
};

/// The robot stands at the lab's table and carries a ball. Judged at uniform joint vectors, and in motion: 60 pictures
/// a second from one such vector to the next, the fastest joint at half its velocity. CPU time of the thread for each
/// picture, placing everything included. Prints, and writes to `json`:
///   touching_mean_ms, _p99_ms   which couples touch                               (prediction/contact)
///   distances_mean_ms, _p99_ms  all couples within 50 mm, with nearest points
///   least_mean_ms, _p99_ms      the nearest couple alone
///   motion_...                  the same in motion
///   fcl_, bullet_               the same of FCL and Bullet used plainly; bullet_ of distances: of the first peer_poses
///   touching_agree, bullet_touching_agree, distances_differ_mm   shares of poses with FCL's answer; largest difference
///   hand_mean_ms, _p99_ms, hand_contact, hand_touching   of the arm that is shown while a hand goes from one uniform
///   pose to the next at 0.5 m/s: SlidingHand's time a picture; shares of pictures in which contact stops it, and in
///   which parts of it touch: 0. null where the links do not make an arm, or every one of the poses touches couples,
///   triangles, touching, near_couples   of the scene; share of poses with contact; couples within 50 mm, mean
/// Returns 1 where FCL's plain answers are others than ours, or the shown arm touches, else 0. Throws InputError as
/// read_urdf and ContactModel.
int bench_prediction_contact(const PredictionContactOptions& options);

}  // namespace foresight
