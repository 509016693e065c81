#include "calibration/robot/hand_eye_verdict.hpp"

#include <algorithm>
#include <array>

#include "calibration/robot/hand_eye_start.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kOther = 12;                   // times the median misfit: a pose of another image, not noise
constexpr double kLeastOther = 5e-3;            // metres
constexpr double kFits = 4;                     // times the median misfit of those that are used
constexpr double kLeastFit = 3e-3;              // metres
constexpr double kMostLeftOut = 0.2;            // of all views
constexpr double kLargestError = 0.01;          // of the image's width: what is drawn there belongs to another thing
constexpr double kSlipped = 0.25;               // of the misfit
constexpr double kOpenRad = 0.1, kOpenM = 0.1;  // standard deviations from which a parameter counts as open

/// Where the board stands by each robot pose, and by each image.
class BoardPlaces {
 public:
  BoardPlaces(const HandEyeData& data, const HandEyeSummary& summary) : data_(data), summary_(summary) {
    std::vector<Eigen::Vector3d> p_board;
    for (const Eigen::Vector3d& p : data.corners.p_board) p_board.push_back(summary.board_scale * p);
    std::vector<double> used;
    for (std::size_t v = 0; v < data.poses.size(); ++v) {
      seen_.push_back(board_pose(summary.camera, p_board, data.corners.views[v]).T_camera_board);
      if (summary.views[v].used) used.push_back(misfit(v, v));
    }
    limit_ = std::max(kLeastFit, kFits * median(std::move(used)));
  }

  Pose predicted(std::size_t robot) const {
    return predicted_board(summary_.mount, data_.poses[robot].T_base_flange, summary_.X, summary_.Y);
  }
  Pose off(std::size_t image) const { return predicted(image).inverse() * seen_[image]; }
  double misfit(std::size_t image, std::size_t robot) const { return misfit_m(predicted(robot), seen_[image]); }

  /// The robot pose that puts the board where `image` shows it, other than its own.
  std::optional<std::size_t> fitting(std::size_t image) const {
    std::optional<std::size_t> best;
    for (std::size_t robot = 0; robot < data_.poses.size(); ++robot)
      if (robot != image && misfit(image, robot) < (best ? misfit(image, *best) : limit_)) best = robot;
    return best;
  }

 private:
  const HandEyeData& data_;
  const HandEyeSummary& summary_;
  std::vector<Pose> seen_;
  double limit_ = 0;
};

void name_contradictions(const BoardPlaces& places, const std::vector<std::size_t>& left_out, HandEyeSummary& summary) {
  for (const std::size_t v : left_out) {
    const Pose off = places.off(v);
    summary.notes.push_back("view " + summary.views[v].name +
                            " is left out: its robot pose contradicts the others by " +
                            readable(1e3 * off.translation().norm(), 1) + " mm and " +
                            readable(57.29578 * rotation_vector(off.linear()).norm(), 1) + " degrees");
  }
}

/// Poses that fit the image of another view: two of them exchanged, or rows that slipped.
std::size_t judge_order(const BoardPlaces& places, const std::vector<std::size_t>& left_out, HandEyeSummary& summary) {
  std::size_t explained = 0;
  for (const std::size_t v : left_out) {
    const auto other = places.fitting(v);
    if (!other) continue;
    ++explained;
    const std::string a = summary.views[v].name, b = summary.views[*other].name;
    if (places.fitting(*other) != v) {
      summary.verdict.object(
          "the image of view " + a + " shows the board where the robot pose of view " + b + " has it",
          "give each image the pose at which it was taken: a row may be missing or stand twice");
    } else if (v < *other) {
      summary.verdict.object("the robot poses of views " + a + " and " + b + " are exchanged",
                             "exchange them in --poses (or --joints), and solve again");
    }
  }
  return explained;
}

/// Whether all poses fit the images if they are taken `rows` rows later.
bool fits_later(const HandEyeData& data, const HandEyeSummary& summary, std::ptrdiff_t rows, double misfit_m) {
  std::vector<RobotPose> poses;
  std::vector<Pose> seen;
  for (std::size_t v = 0; v < data.poses.size(); ++v) {
    const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(v) + rows;
    if (at < 0 || at >= std::ssize(data.poses)) continue;
    poses.push_back(data.poses[static_cast<std::size_t>(at)]);
    seen.push_back(board_pose(summary.camera, data.corners.p_board, data.corners.views[v]).T_camera_board);
  }
  return start_hand_eye(summary.mount, poses, seen, std::array{Pose::Identity()}).misfit_m < kSlipped * misfit_m;
}

std::string cure_of_order(const HandEyeData& data, const HandEyeSummary& summary) {
  const double misfit_m =
      1e-3 * (summary.mount == CameraMount::fixed ? summary.start_mm_fixed : summary.start_mm_moving);
  for (const std::ptrdiff_t rows : {1, -1})
    if (fits_later(data, summary, rows, misfit_m))
      return std::string("each image fits the pose ") + (rows > 0 ? "after" : "before") +
             " its own: a row of --poses is missing, or one too many stands before the first";
  return "check that poses and images belong together, that the arm stood still in each, and that nothing else moved";
}

void judge_error(const HandEyeData& data, HandEyeSummary& summary) {
  const double width = summary.camera.width > 0 ? summary.camera.width : 2 * summary.camera.lens[2];
  const double error = std::max(summary.loo_px, summary.uncorrected_px);
  if (error <= kLargestError * width) return;
  summary.verdict.object("the robot puts the board " + readable(error, 1) +
                             " px from where views that were left out show it; 1 % of the image's width is the limit",
                         cure_of_order(data, summary));
}

void judge_open(const char* name, const Vector6d& sigma, Verdict& verdict) {
  const double turn = sigma.head<3>().maxCoeff(), shift = sigma.tail<3>().maxCoeff();
  if (turn > kOpenRad)
    verdict.object(std::string(name) + " turn is open to " + readable(turn, 2) + " rad",
                   "add poses that turn the wrist about another axis");
  if (shift > kOpenM)
    verdict.object(std::string(name) + " shift is open to " + readable(shift, 2) + " m",
                   "add poses that turn the wrist by larger angles about two axes");
}

}  // namespace

std::vector<bool> belong_together(const std::vector<double>& misfits_m) {
  const double limit = std::max(kLeastOther, kOther * median(misfits_m));
  std::vector<bool> out;
  for (const double misfit : misfits_m) out.push_back(misfit <= limit);
  return out;
}

void judge_unsolved(const HandEyeData& data, const std::string& why, HandEyeSummary& summary) {
  summary.verdict.object("no place of camera and board brings the robot poses and the images together: " + why,
                         cure_of_order(data, summary));
}

void judge_hand_eye(const HandEyeData& data, HandEyeSummary& summary) {
  std::vector<std::size_t> left_out;
  for (std::size_t v = 0; v < summary.views.size(); ++v)
    if (!summary.views[v].used) left_out.push_back(v);
  if (!left_out.empty()) {
    const BoardPlaces places(data, summary);
    name_contradictions(places, left_out, summary);
    const std::size_t explained = judge_order(places, left_out, summary);
    const auto most = static_cast<std::size_t>(kMostLeftOut * static_cast<double>(summary.views.size()));
    if (left_out.size() - explained > std::max<std::size_t>(1, most))
      summary.verdict.object(std::to_string(left_out.size()) + " of " + std::to_string(summary.views.size()) +
                                 " robot poses contradict the others",
                             "check that each pose belongs to its image and that nothing moved but the arm; take those "
                             "views again");
  }
  judge_open("the camera's", summary.X_sigma, summary.verdict);
  judge_open("the board's", summary.Y_sigma, summary.verdict);
  judge_error(data, summary);
}

}  // namespace foresight
