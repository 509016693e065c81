// Pairs as a robot side describes them, for tests of the line.
#pragma once

#include "link/messages/foresight_messages.hpp"
#include "tests/support/moving_picture.hpp"

namespace foresight::link {

/// A pair of `picture`'s instant whose every number follows from `number`; no coding, no data.
inline StereoFrame described(std::uint64_t session, std::uint64_t number, const StereoPicture& picture) {
  StereoFrame out;
  out.header.frame_id = "world";
  out.session = session;
  out.number = number;
  out.stamps = {picture.captured.ns + 1'000'000, picture.captured.ns + 2'000'000, 0, 0};
  out.quality = "tags";
  out.predicted_px = 0.25;
  out.joints_status = 1;
  const auto n = static_cast<double>(number);
  out.joints = {{"elbow", JointSample::kKnown, 0.001 * n},
                {"wrist", JointSample::kLastHeardOf, -0.002 * n},
                {"finger", JointSample::kNeverKnown, 0}};
  out.lenses_revision = "a1";
  for (CodedImage* image : {&out.left, &out.right}) {
    image->capture_ns = picture.captured.ns;
    image->uncertainty_ns = 500;
    image->width = static_cast<std::uint32_t>(picture.left.cols);
    image->height = static_cast<std::uint32_t>(picture.left.rows);
    image->has_pose = true;
    image->t_world_camera.position = {0.01 * n, 1.0 / 3, image == &out.left ? 0.0 : 0.065};
    image->t_world_camera.orientation = {0, std::sin(0.001 * n), 0, std::cos(0.001 * n)};
  }
  return out;
}

}  // namespace foresight::link
