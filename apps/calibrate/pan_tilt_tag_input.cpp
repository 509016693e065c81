#include "apps/calibrate/pan_tilt_tag_input.hpp"

#include <algorithm>
#include <set>

#include "apps/calibrate/lens_file.hpp"
#include "apps/calibrate/pan_tilt_input.hpp"
#include "apps/calibrate/run_input.hpp"
#include "calibration/registration/calibrated_head.hpp"
#include "calibration/result/result_file.hpp"
#include "calibration/robot/robot_poses.hpp"
#include "calibration/target/image_input.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "pictures/picture_file.hpp"
#include "session/run_recorder.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr Duration kSameInstant{200'000};  // of two cameras: a head at 1 rad/s turns by 0.2 mrad

constexpr Duration kPartner{20'000'000};

struct Picture {
  fs::path file;
  int camera = 0;
};

/// Pictures that were taken at one instant; their view has no tags yet.
struct Shot {
  PanTiltView view;
  RobotTime time;
  std::vector<Picture> pictures;
};

cv::Mat read_grey(const fs::path& file, const CameraModel& lens) {
  const cv::Mat grey = read_picture(file, PictureColours::grey);
  if (grey.cols != lens.width || grey.rows != lens.height)
    throw InputError(file.string(),
                     "is of " + std::to_string(grey.cols) + "x" + std::to_string(grey.rows) + ", the lens of " +
                         std::to_string(lens.width) + "x" + std::to_string(lens.height),
                     "give the --camera that took it");
  return grey;
}

TagDetector detector_of(const PanTiltTagInput& input, const std::string& family) {
  TagDetector::Options options;
  options.family = family;
  if (input.photometric) options.inverse_response = read_inverse_response(*input.photometric);
  options.decimate = 1;  // there is time
  return TagDetector(options);
}

/// Finds what is in the pictures instead of the map's tags.
std::string explain_no_tags(const std::vector<Shot>& shots, const PanTiltTagInput& input, const TagViews& out,
                            const std::set<int>& strangers) {
  if (!strangers.empty()) {
    std::string ids;
    for (const int id : strangers) ids += (ids.empty() ? "" : ", ") + std::to_string(id);
    return "tags " + ids + " are in the pictures, none of them in " + input.tags->string();
  }
  std::string best;
  std::size_t most = 1;
  for (const std::string family : {"tag36h11", "tag25h9", "tag16h5"}) {
    if (family == input.family) continue;
    TagDetector detector = detector_of(input, family);
    std::size_t found = 0;
    for (std::size_t i = 0; i < shots.size(); i += std::max<std::size_t>(1, shots.size() / 3))
      for (const Picture& picture : shots[i].pictures)
        for (const DetectedTag& tag :
             detector.detect(read_grey(picture.file, out.cameras.cameras[static_cast<std::size_t>(picture.camera)])))
          found += out.map.contains(tag.id);
    if (found > most) most = found, best = family;
  }
  return "0 tags of " + input.family + (best.empty() ? ", nor of another family" : "; " + best + " fits");
}

void find_tags(std::vector<Shot>& shots, const PanTiltTagInput& input, TagViews& out) {
  TagDetector detector = detector_of(input, input.family);
  std::set<int> strangers;
  std::size_t known = 0;
  for (Shot& shot : shots)
    for (const Picture& picture : shot.pictures) {
      const CameraModel& lens = out.cameras.cameras[static_cast<std::size_t>(picture.camera)];
      for (const DetectedTag& tag : detector.detect(read_grey(picture.file, lens))) {
        const auto at = out.map.find(tag.id);
        if (at == out.map.end()) {
          strangers.insert(tag.id);
          continue;
        }
        shot.view.tags.push_back({tag.id, picture.camera, at->second, tag.corners});
        ++known;
      }
    }
  if (known == 0)
    throw InputError(input.run ? "--run" : "--images", explain_no_tags(shots, input, out, strangers),
                     "give the --family and the --tags that were in view");
}

std::vector<Shot> shots_of_images(const PanTiltTagInput& input) {
  const std::vector<fs::path> left = list_images(*input.images);
  const std::vector<fs::path> right = input.right ? list_images(*input.right) : std::vector<fs::path>{};
  if (input.right && right.size() != left.size())
    throw InputError("--right", counted(right.size(), "picture") + " for " + std::to_string(left.size()) + " left ones",
                     "give one right picture for each left one, in the same order");
  std::vector<std::string> names;
  for (const fs::path& file : left) names.push_back(file.stem().string());
  const std::vector<PanTiltAngles> angles = read_angles_of(input.angles, names);
  std::vector<PanTiltSample> samples(left.size());
  for (std::size_t i = 0; i < left.size(); ++i) samples[i] = {names[i], angles[i], Pose::Identity()};
  if (input.in_order) came_from_order(samples);
  std::vector<Shot> shots;
  for (std::size_t i = 0; i < left.size(); ++i) {
    Shot shot{{names[i], samples[i].angles, {0, 0}, {}}, {}, {{left[i], 0}}};
    if (input.right) shot.pictures.push_back({right[i], 1});
    shots.push_back(shot);
  }
  return shots;
}

std::vector<Shot> listed(const fs::path& list, int camera) {
  std::vector<Shot> out;
  for (const TimedPicture& picture : read_picture_list(list))
    out.push_back({{picture.file.stem().string(), {}, {0, 0}, {}}, picture.time, {{picture.file, camera}}});
  return out;
}

/// Right pictures of the same instant belong to the left one's view, others have one of their own.
std::vector<Shot> shots_of_run(const PanTiltTagInput& input, bool pair) {
  std::vector<Shot> all = listed(*input.run / "rgb.txt", 0), right;
  if (pair) right = listed(*input.run / "rgb_right.txt", 1);
  std::vector<Shot> some;
  const std::size_t count = std::min(all.size(), static_cast<std::size_t>(input.most_views));
  for (std::size_t i = 0; i < count; ++i) some.push_back(all[i * all.size() / count]);
  const std::size_t lefts = some.size();
  for (std::size_t i = 0; i < lefts && !right.empty(); ++i) {
    const auto distance = [&](const Shot& shot) { return std::chrono::abs(shot.time - some[i].time); };
    const Shot& nearest = *std::min_element(right.begin(), right.end(),
                                            [&](const Shot& a, const Shot& b) { return distance(a) < distance(b); });
    if (distance(nearest) <= kSameInstant) {
      some[i].pictures.push_back(nearest.pictures[0]);
    } else if (distance(nearest) <= kPartner) {
      some.push_back(nearest);
      some.back().view.name += " right";
    }
  }
  return some;
}

std::vector<JointRow> read_joints(const PanTiltTagInput& input) {
  const fs::path file = input.joints.value_or(beside_run(*input.run, "-joints.csv"));
  if (!fs::exists(file))
    throw InputError(file.string(), "is missing", "give the recorded joints with --joints: rows time pan tilt");
  return read_named_joints(file, input.joint_names, "--joint-names");
}

void require(bool given, const char* option, const char* what) {
  if (!given) throw InputError(option, "is missing", what);
}

}  // namespace

TagViews read_tag_views(const PanTiltTagInput& given) {
  PanTiltTagInput input = given;
  if (input.run.has_value() == input.images.has_value())
    throw InputError("--images, --run", input.run ? "are both given" : "are both missing",
                     "give --images DIR with --angles FILE, or --run RUN");
  if (input.run) {
    require_run(*input.run);
    if (!input.camera) {
      input.camera = *input.run / "camera.yaml";
      if (const fs::path right = *input.run / "camera_right.yaml"; fs::exists(right)) input.camera_right = right;
    }
    if (!input.tags && fs::exists(*input.run / "tags.txt")) input.tags = *input.run / "tags.txt";
  }
  require(input.tags.has_value(), "--tags", "give the map of the tags: rows id corner x y z");
  require(input.camera.has_value(), "--camera", "give the calibrated lens, of `calibrate stereo` or `intrinsics`");
  TagViews out;
  out.map = read_tag_map(*input.tags);
  out.cameras = read_cameras_file(*input.camera, input.camera_right);
  const bool pair = out.cameras.cameras.size() == 2;
  if (input.right && !pair)
    throw InputError("--right", "there is no lens for it", "give a result of `calibrate stereo`, or --camera-right");
  std::vector<Shot> shots = input.run ? shots_of_run(input, pair) : shots_of_images(input);
  if (input.run) {
    out.joints = read_joints(input);
    out.encoders.emplace(out.joints, HeadEncoders::Options{});
  }
  find_tags(shots, input, out);
  for (Shot& shot : shots) {
    std::array<fs::path, 2> files;
    for (const Picture& picture : shot.pictures) files[static_cast<std::size_t>(picture.camera)] = picture.file;
    out.files[shot.view.name] = files;
    out.views.push_back(std::move(shot.view));
    if (input.run) out.times.push_back(shot.time);
  }
  return out;
}

std::vector<PanTiltView> views_at(const TagViews& all, double offset_s) {
  if (!all.encoders) return all.views;
  std::vector<PanTiltView> out;
  for (std::size_t i = 0; i < all.views.size(); ++i) {
    const auto answer = all.encoders->at(all.times[i] + seconds(offset_s));
    if (!answer) continue;
    out.push_back(all.views[i]);
    out.back().angles = answer->angles;
    out.back().rate = answer->rate;
  }
  if (out.empty())
    throw InputError("--joints", "the encoders tell nothing of the times of the pictures",
                     "give the joints that were recorded with them, on the same clock");
  return out;
}

}  // namespace foresight
