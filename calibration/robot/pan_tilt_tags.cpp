#include "calibration/robot/pan_tilt_tags.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

#include "calibration/robot/pan_tilt_scoring.hpp"
#include "calibration/robot/pan_tilt_tag_problem.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kOutlier = 5;            // robust standard deviations
constexpr double kStartPx = 4;            // a tag that is farther off from a view's first pose has no part in it
constexpr double kStrange = 0.3;          // share of rejected corners above which the map cannot be right
constexpr double kWorstCornerPx = 3;      // of a found corner: beyond it, the map is another one
constexpr double kLargestLeftOut = 0.01;  // of views left out, of the image's width
constexpr int kSeenOften = 3;             // pictures of a tag, from which on its place in the map is judged
// All tags larger or smaller than the map has them, by both: a camera's response moves corners by half a pixel.
constexpr double kOtherTagSize = 0.03, kOtherTagPx = 0.6;
constexpr double kFirstCornerPx = 1;  // both noises before anything is known
constexpr double kFirstShaft = 2e-3;  // rad
constexpr double kLeastShaft = 2e-5;  // rad, a few counts of a good encoder

/// The left camera from one view's tags in one camera, or nothing.
std::optional<Pose> view_pose(const PanTiltView& view, const CalibratedCameras& cameras, int camera) {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> rays;
  const CameraModel& lens = cameras.cameras[static_cast<std::size_t>(camera)];
  for (const SeenTag& tag : view.tags)
    for (std::size_t c = 0; c < 4 && tag.camera == camera; ++c)
      if (const auto ray = unproject(lens, tag.pixels[c]); ray && ray->z() > 0.05) {
        points.emplace_back(tag.corners[c].x(), tag.corners[c].y(), tag.corners[c].z());
        rays.emplace_back(ray->x() / ray->z(), ray->y() / ray->z());
      }
  if (points.size() < 8) return std::nullopt;
  const cv::Matx33d unit = cv::Matx33d::eye();
  cv::Vec3d r, t;
  std::vector<int> inliers;
  try {
    if (!cv::solvePnPRansac(points, rays, unit, cv::noArray(), r, t, false, 200,
                            static_cast<float>(kStartPx / lens.lens[0]), 0.999, inliers, cv::SOLVEPNP_SQPNP) ||
        inliers.size() < 8)
      return std::nullopt;
    std::vector<cv::Point3d> near_points;
    std::vector<cv::Point2d> near_rays;
    for (const int i : inliers)
      near_points.push_back(points[static_cast<std::size_t>(i)]),
          near_rays.push_back(rays[static_cast<std::size_t>(i)]);
    cv::solvePnP(near_points, near_rays, unit, cv::noArray(), r, t, false, cv::SOLVEPNP_SQPNP);
    cv::solvePnPRefineLM(near_points, near_rays, unit, cv::noArray(), r, t);
  } catch (const cv::Exception&) {
    return std::nullopt;
  }
  cv::Matx33d R;
  cv::Rodrigues(r, R);
  Pose T_camera_world = Pose::Identity();
  Eigen::Matrix3d turn;
  cv::cv2eigen(cv::Mat(R), turn);
  T_camera_world.linear() = turn;
  T_camera_world.translation() << t[0], t[1], t[2];
  const Pose T_world_camera = T_camera_world.inverse();
  return camera == 1 ? Pose(T_world_camera * cameras.T_left_right.inverse()) : T_world_camera;
}

std::vector<PanTiltSample> start_samples(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras) {
  std::vector<PanTiltSample> samples;
  for (const PanTiltView& view : views) {
    std::optional<Pose> pose = view_pose(view, cameras, 0);
    if (!pose && cameras.cameras.size() > 1) pose = view_pose(view, cameras, 1);
    if (pose) samples.push_back({view.name, view.angles, *pose});
  }
  if (samples.size() < kFewestHeadViews)
    throw InputError("--tags",
                     "only " + std::to_string(samples.size()) + " of " + std::to_string(views.size()) +
                         " views give a pose of the camera that agrees with the map",
                     "see that two and more tags are in view, and that --tags and --camera belong to the pictures");
  return samples;
}

std::vector<PanTiltView> with_tags(const std::vector<PanTiltView>& given) {
  std::vector<PanTiltView> views;
  for (const PanTiltView& view : given)
    if (!view.tags.empty()) views.push_back(view);
  if (views.size() < kFewestHeadViews)
    throw InputError("--images", std::to_string(views.size()) + " views show tags of the map",
                     "take at least 8, better 30, over both joints");
  return views;
}

// Errors of the corners that count.
std::vector<double> counting(const PanTiltTagState& state, std::size_t k, const std::vector<double>& errors) {
  std::vector<double> out;
  for (std::size_t i = 0; i < errors.size(); ++i)
    if (!state.left_out[k][i / 4]) out.push_back(errors[i]);
  return out;
}

Pose fitted_left(const PanTiltTagState& state, const PanTiltView& view, std::size_t k) {
  PanTiltView moved = view;
  moved.angles.pan += state.shafts[k][0] / state.head.joints[0];
  moved.angles.tilt += state.shafts[k][1] / state.head.joints[1];
  return predicted_left(state, moved);
}

// Noise of a coordinate from the distances of all corners that count.
double corner_noise(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                    const PanTiltTagState& state) {
  std::vector<double> all;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto some = counting(state, k, corner_errors(cameras, fitted_left(state, views[k], k), views[k]));
    all.insert(all.end(), some.begin(), some.end());
  }
  const double unknowns = kHeadParameters + 2.0 * static_cast<double>(views.size());
  const double redundant = redundancy(unknowns, 2.0 * static_cast<double>(all.size()));
  return std::max(1e-3, robust_sigma_of_lengths(std::move(all)) / redundant);
}

void fit_with_noise(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras, PanTiltTagState& state,
                    int rounds) {
  for (int round = 0; round < rounds; ++round) {
    fit_pan_tilt_tags(views, cameras, state);
    state.corner_px = corner_noise(views, cameras, state);
    const PanTiltTagCovariance covariance = pan_tilt_tag_covariance(views, cameras, state);
    double squares = 0;
    for (const auto& e : state.shafts) squares += (e[0] * e[0] + e[1] * e[1]) / 2;
    const double before = state.shaft_rad;
    state.shaft_rad = std::max(
        kLeastShaft, std::sqrt(squares / static_cast<double>(state.shafts.size()) + covariance.shaft_variance));
    if (has_settled(before, state.shaft_rad, 0.02)) return;
  }
}

int reject(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras, PanTiltTagState& state) {
  int points = 0;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto errors = corner_errors(cameras, fitted_left(state, views[k], k), views[k]);
    for (std::size_t i = 0; i < views[k].tags.size(); ++i) {
      const double worst = *std::max_element(&errors[4 * i], &errors[4 * i] + 4);
      state.left_out[k][i] = worst > kOutlier * state.corner_px;
      points += state.left_out[k][i] ? 4 : 0;
    }
  }
  return points;
}

PanTiltTagState solve_state(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                            const PanTiltTagOptions& options, PanTiltTagSummary& summary) {
  PanTiltOptions first;
  first.gains = false, first.score = false, first.inverted = false, first.backlash = options.backlash;
  PanTiltTagState state;
  state.head = to_state(solve_pan_tilt(start_samples(views, cameras), first).model);
  choose_joints(angles_of(views), options.gains.value_or(false), options.backlash, state.head, summary.notes);
  for (const int joint : state.head.held_joints) state.head.joints[static_cast<std::size_t>(joint)] = joint < 2 ? 1 : 0;
  state.offset_held = !options.offset;
  state.shafts.assign(views.size(), {0, 0});
  for (const PanTiltView& view : views) state.left_out.emplace_back(view.tags.size(), 0);
  state.corner_px = kFirstCornerPx, state.shaft_rad = kFirstShaft;
  fit_with_noise(views, cameras, state, 4);
  state.robust = false;
  for (int round = 0; round < 2; ++round) {
    summary.rejected_points = reject(views, cameras, state);
    fit_with_noise(views, cameras, state, 6);
  }
  for (const PanTiltView& view : views) summary.tags += static_cast<int>(view.tags.size());
  const bool many = summary.rejected_points > kStrange * 4 * summary.tags;
  if (many || state.corner_px > kWorstCornerPx)
    throw InputError(
        "--tags",
        (many ? std::to_string(summary.rejected_points) + " of " + std::to_string(4 * summary.tags) +
                    " corners are not where map and head would have them"
              : "the corners are " + readable(state.corner_px, 1) + " px from where map and head would have them"),
        "check the order of the corners in the map (lower left, lower right, upper right, upper left of "
        "the print), that it is in metres, and that angles and pictures belong together");
  return state;
}

/// Tags that most of their pictures do not show where the map has them.
void name_moved_tags(const std::vector<PanTiltView>& views, const PanTiltTagState& state, PanTiltTagSummary& summary) {
  struct Count {
    int seen = 0, left_out = 0;
  };
  std::map<int, Count> counts;
  for (std::size_t k = 0; k < views.size(); ++k)
    for (std::size_t i = 0; i < views[k].tags.size(); ++i) {
      Count& count = counts[views[k].tags[i].id];
      ++count.seen, count.left_out += state.left_out[k][i] ? 1 : 0;
    }
  for (const auto& [id, count] : counts)
    if (count.seen >= kSeenOften && 2 * count.left_out > count.seen)
      summary.notes.push_back("tag " + std::to_string(id) + " does not stand where the map has it (left out in " +
                              std::to_string(count.left_out) + " of " + std::to_string(count.seen) +
                              " pictures): measure it anew, or take it out of --tags");
}

/// How large the tags that count are, over what the map says.
void judge_size_of_tags(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                        const PanTiltTagState& state, PanTiltTagSummary& summary) {
  std::vector<double> sizes, off_px;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto predicted = predicted_corners(cameras, fitted_left(state, views[k], k), views[k]);
    for (std::size_t i = 0; i < views[k].tags.size(); ++i) {
      const auto first = predicted.begin() + 4 * static_cast<std::ptrdiff_t>(i);
      if (state.left_out[k][i] || std::count(first, first + 4, std::nullopt) > 0) continue;
      Eigen::Matrix<double, 2, 4> seen, mapped;
      for (int c = 0; c < 4; ++c)
        seen.col(c) = views[k].tags[i].pixels[static_cast<std::size_t>(c)], mapped.col(c) = **(first + c);
      seen.colwise() -= seen.rowwise().mean().eval();
      mapped.colwise() -= mapped.rowwise().mean().eval();
      sizes.push_back(seen.norm() / mapped.norm());
      off_px.push_back((seen.norm() - mapped.norm()) / 2);  // root mean square of four
    }
  }
  if (sizes.empty()) return;
  const double size = median(std::move(sizes));
  if (std::abs(size - 1) > kOtherTagSize && std::abs(median(std::move(off_px))) > kOtherTagPx)
    summary.notes.push_back("the tags look " + readable(size, 3) +
                            " times as large as the map has them: measure the side of their black squares, and correct "
                            "--tags");
}

void score_left_out(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                    const PanTiltTagState& state, PanTiltTagSummary& summary) {
  std::vector<double> all;
  leave_each_out(
      views.size(), state, [&](PanTiltTagState& without, int k) { fit_pan_tilt_tags(views, cameras, without, k); },
      [&](std::size_t k, const PanTiltTagState& without) {
        const auto errors = counting(state, k, corner_errors(cameras, predicted_left(without, views[k]), views[k]));
        summary.loo_view_px.push_back(root_mean_square(errors));
        all.insert(all.end(), errors.begin(), errors.end());
      });
  summary.loo_px = root_mean_square(all);
}

PanTiltTagSummary with_gains_if_better(const std::vector<PanTiltView>& views, const CalibratedCameras& cameras,
                                       const PanTiltTagOptions& options) {
  return choose_gains(
      options, [&](const PanTiltTagOptions& choice) { return solve_pan_tilt_tags(views, cameras, choice); },
      [](const PanTiltTagSummary& with, const PanTiltTagSummary& without) { return with.loo_px / without.loo_px; });
}

// The way of a joint decides where its shaft is; without it, a view would pull the model to its own side.
std::vector<PanTiltView> of_known_ways(const std::vector<PanTiltView>& views, bool backlash,
                                       std::vector<std::string>& notes) {
  if (!backlash) return views;
  PanTiltState chosen;
  std::vector<std::string> said_later;
  choose_joints(angles_of(views), false, true, chosen, said_later);
  std::vector<PanTiltView> out;
  for (const PanTiltView& view : views) {
    bool known = true;
    for (int joint = 0; joint < 2; ++joint) {
      const auto& held = chosen.held_joints;
      const bool estimated = std::find(held.begin(), held.end(), 2 + joint) == held.end();
      known = known && !(estimated && view.angles.came[static_cast<std::size_t>(joint)] == 0);
    }
    if (known) out.push_back(view);
  }
  if (out.size() < views.size())
    notes.push_back(std::to_string(views.size() - out.size()) +
                    " views are left out: nothing tells from which side their joints came");
  return out;
}

}  // namespace

ViewPrints prints_of(const std::vector<PanTiltView>& views) {
  ViewPrints out;
  for (const PanTiltView& view : views) {
    std::vector<Eigen::Vector2d> pixels;
    for (const SeenTag& tag : view.tags) pixels.insert(pixels.end(), tag.pixels.begin(), tag.pixels.end());
    if (!pixels.empty()) out.emplace_back(pixels);
  }
  return out;
}

std::vector<std::optional<Eigen::Vector2d>> predicted_corners(const CalibratedCameras& cameras,
                                                              const Pose& T_world_left, const PanTiltView& view) {
  std::vector<std::optional<Eigen::Vector2d>> out;
  const Pose T_left_world = T_world_left.inverse();
  for (const SeenTag& tag : view.tags)
    for (const Eigen::Vector3d& corner : tag.corners)
      out.push_back(project(cameras.cameras[static_cast<std::size_t>(tag.camera)],
                            to_camera(cameras, tag.camera, T_left_world * corner)));
  return out;
}

std::vector<double> corner_errors(const CalibratedCameras& cameras, const Pose& T_world_left, const PanTiltView& view) {
  std::vector<double> errors;
  const auto predicted = predicted_corners(cameras, T_world_left, view);
  for (std::size_t i = 0; i < predicted.size(); ++i)
    errors.push_back(predicted[i] ? (*predicted[i] - view.tags[i / 4].pixels[i % 4]).norm()
                                  : std::numeric_limits<double>::infinity());
  return errors;
}

PanTiltTagSummary solve_pan_tilt_tags(const std::vector<PanTiltView>& given, const CalibratedCameras& cameras,
                                      const PanTiltTagOptions& options) {
  if (!options.gains && options.score) return with_gains_if_better(given, cameras, options);
  PanTiltTagSummary summary;
  const std::vector<PanTiltView> views = of_known_ways(with_tags(given), options.backlash, summary.notes);
  require_sweeps(angles_of(views));
  PanTiltTagState state = solve_state(views, cameras, options, summary);
  const PanTiltTagCovariance covariance = pan_tilt_tag_covariance(views, cameras, state);
  if (!covariance.open.empty())
    throw InputError("--angles", "these parameters of the head stay open: " + joined(covariance.open),
                     "sweep both joints, each at several angles of the other and at several speeds");
  summary.model = to_model(state.head);
  summary.offset_s = state.offset_s;
  summary.names = pan_tilt_names(state.head);
  if (options.offset) summary.names.emplace_back("offset_s");
  summary.sigmas = sigmas_of(covariance.head);
  summary.corner_px = state.corner_px, summary.shaft_rad = state.shaft_rad;
  summary.pose_sigma = covariance.pose_sigma;
  std::vector<double> all;
  for (std::size_t k = 0; k < views.size(); ++k) {
    const auto errors = counting(state, k, corner_errors(cameras, fitted_left(state, views[k], k), views[k]));
    summary.view_names.push_back(views[k].name), summary.angles.push_back(views[k].angles);
    summary.view_px.push_back(root_mean_square(errors));
    all.insert(all.end(), errors.begin(), errors.end());
  }
  summary.in_sample_px = root_mean_square(all);
  name_moved_tags(views, state, summary);
  judge_size_of_tags(views, cameras, state, summary);
  if (options.score) score_left_out(views, cameras, state, summary);
  judge_sigmas(summary.names, summary.sigmas, summary.verdict);
  if (const double limit = kLargestLeftOut * cameras.left().width; summary.loo_px > limit)
    summary.verdict.object("views that were left out are predicted to " + readable(summary.loo_px, 1) +
                               " px by the encoders; " + readable(limit, 1) + " px are the limit",
                           "check that angles and pictures belong together, and that the head's joints do not slip");
  return summary;
}

}  // namespace foresight
