#include "scene/run_folder.hpp"

#include <algorithm>
#include <map>

#include "common/error.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"
#include "scene/camera_info.hpp"
#include "scene/files.hpp"
#include "scene/scene_reader.hpp"
#include "scene/text_table.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

constexpr const char* kForm =
    "a run folder holds camera.yaml, rgb.txt, trajectory.txt and scene.ply or scene.yaml; add what is missing";

// A file of fixed name; lexists, so that a broken link is reported and not taken for absent.
bool has_member(const fs::path& root, const std::string& name) {
  std::error_code error;
  return fs::symlink_status(root / name, error).type() != fs::file_type::not_found && !error;
}

fs::path member(const fs::path& root, const std::string& name) {
  if (!has_member(root, name)) throw InputError((root / name).string(), "is missing", kForm);
  return resolve_inside(root, root, name, root.string());
}

struct ListedImage {
  RunImage image;
  std::string where;  // its line
};

// rgb.txt or rgb_right.txt, still without poses.
std::vector<ListedImage> read_images(const fs::path& root, const fs::path& list) {
  std::vector<ListedImage> out;
  std::map<std::string, int> lines;  // stem -> line
  for_each_row(list, "time file", [&](const TextRow& row) {
    RunImage image;
    image.time = time_field(row, 0);
    if (!out.empty()) require_ascending(row, out.back().image.time, image.time);
    image.file = resolve_inside(root, root, row.fields[1], row.where());
    image.stem = image.file.stem().string();
    const auto [other, is_new] = lines.emplace(image.stem, row.line);
    if (!is_new)
      throw InputError(row.where(),
                       "the image name " + in_quotes(image.stem) + " is that of line " + std::to_string(other->second),
                       "rename one of the two, results are named after it");
    out.push_back({std::move(image), row.where()});
  });
  return out;
}

/// Cure of stamps of which one has no pose. Of another unit are those whose last one lies far behind all poses, and
/// beside one in that unit.
std::string cure_of_stamps(const PoseTrack& track, RobotTime last) {
  constexpr Duration kBeside = std::chrono::seconds(1);
  const RobotTime begin = track.samples().front().time, end = track.samples().back().time;
  const bool is_far = last - end > std::max(kBeside, end - begin);
  for (const auto& [unit, per_second] :
       {std::pair{"milliseconds", 1'000}, {"microseconds", 1'000'000}, {"nanoseconds", 1'000'000'000}}) {
    const RobotTime meant{last.ns / per_second};
    if (is_far && std::chrono::abs(track.nearest(meant).time - meant) <= kBeside)
      return std::string("it looks like ") + unit + ": write seconds, as trajectory.txt";
  }
  return "remove the line, or add poses no more than 0.2 s apart on both sides of it";
}

// Gives `listed` its pose; T_left_camera is identity for the left camera. `last` is the last stamp of its list.
void place(ListedImage& listed, const PoseTrack& track, const Pose& T_left_camera, RobotTime last) {
  const PoseTrack::Answer answer = track.at(listed.image.time);
  if (answer.status == StateStatus::invalid) {
    const double away = to_seconds(std::chrono::abs(track.nearest(listed.image.time).time - listed.image.time));
    throw InputError(listed.where,
                     "no pose in trajectory.txt for this image (the nearest is " + std::to_string(away) + " s away)",
                     cure_of_stamps(track, last));
  }
  listed.image.T_world_camera = answer.pose * T_left_camera;
  listed.image.pose_status = answer.status;
}

// Of images that it names by their time; a registration may know only some.
void read_predicted_errors(const fs::path& file, std::vector<RunFrame>& frames) {
  std::map<RobotTime, double> predicted;
  for_each_row(file, "time quality px", [&](const TextRow& row) {
    const auto px = parse_number(row.fields[2]);
    if (!px || !(*px >= 0))
      throw InputError(row.where(), in_quotes(row.fields[2]) + " is no expected error in px", "remove the line");
    predicted[time_field(row, 0)] = *px;
  });
  for (RunFrame& frame : frames) {
    const auto found = predicted.find(frame.left.time);
    if (found == predicted.end()) continue;
    frame.left.predicted_px = found->second;
    if (frame.right) frame.right->predicted_px = found->second;
  }
}

Duration pairing_window(const std::vector<RunFrame>& frames) {
  if (frames.size() < 2) return RunFrame::kLargestOffset;
  std::vector<double> intervals;
  for (std::size_t i = 1; i < frames.size(); ++i)
    intervals.push_back(to_seconds(frames[i].left.time - frames[i - 1].left.time));
  return std::min(seconds(median(std::move(intervals)) / 2), RunFrame::kLargestOffset);
}

// The index of the frame whose left image is nearest to `time`.
std::size_t nearest_frame(const std::vector<RunFrame>& frames, RobotTime time) {
  const auto after = std::lower_bound(frames.begin(), frames.end(), time,
                                      [](const RunFrame& frame, RobotTime t) { return frame.left.time < t; });
  const std::size_t i = static_cast<std::size_t>(after - frames.begin());
  if (i == 0) return 0;
  if (i == frames.size()) return i - 1;
  return time - frames[i - 1].left.time <= frames[i].left.time - time ? i - 1 : i;
}

// Hands each right image to its left one, a left one to the nearer of two; returns how many are left over.
std::size_t pair_images(std::vector<RunFrame>& frames, std::vector<ListedImage> images, const PoseTrack& track,
                        const Pose& T_left_right) {
  const Duration window = pairing_window(frames);
  const RobotTime last = images.empty() ? RobotTime{} : images.back().image.time;
  std::size_t paired = 0;
  for (ListedImage& listed : images) {
    RunFrame& frame = frames[nearest_frame(frames, listed.image.time)];
    const auto offset = [&](const RunImage& image) { return std::chrono::abs(image.time - frame.left.time); };
    if (offset(listed.image) > window) continue;
    if (frame.right && offset(*frame.right) <= offset(listed.image)) continue;
    place(listed, track, T_left_right, last);
    paired += frame.right ? 0 : 1;
    frame.right = std::move(listed.image);
  }
  return images.size() - paired;
}

std::shared_ptr<const SceneModel> read_model(const fs::path& root, const RunFolder::Options& options) {
  if (options.scene) {
    require_regular_file(*options.scene);
    const fs::path folder = canonical_folder(fs::absolute(*options.scene).parent_path());
    return std::make_shared<SceneModel>(read_scene(folder / options.scene->filename(), folder));
  }
  const bool ply = has_member(root, "scene.ply"), yaml = has_member(root, "scene.yaml");
  if (ply && yaml)
    throw InputError(root.string(), "holds scene.ply and scene.yaml", "remove one, or choose one with --scene");
  if (!ply && !yaml)
    throw InputError((root / "scene.ply").string(), "is missing, and so is scene.yaml",
                     "add one of the two, or name a scene with --scene");
  return std::make_shared<SceneModel>(read_scene(member(root, ply ? "scene.ply" : "scene.yaml"), root));
}

std::vector<std::optional<PoseTrack>> read_node_tracks(const fs::path& file, const SceneModel& scene) {
  std::map<std::string, std::vector<PoseTrack::Sample>, std::less<>> tracks;
  for (const Node& node : scene.nodes()) tracks[node.name];
  for_each_row(file, "time node tx ty tz qx qy qz qw", [&](const TextRow& row) {
    const PoseTrack::Sample sample{time_field(row, 0), pose_fields(row, 2)};
    const auto track = tracks.find(row.fields[1]);
    if (track == tracks.end()) {
      std::vector<std::string> names;
      for (const Node& node : scene.nodes()) names.push_back(node.name);
      throw InputError(row.where(), "the scene has no node " + in_quotes(row.fields[1]),
                       did_you_mean(row.fields[1], names));
    }
    if (!track->second.empty()) require_ascending(row, track->second.back().time, sample.time);
    track->second.push_back(sample);
  });
  std::vector<std::optional<PoseTrack>> out;
  for (const Node& node : scene.nodes()) {
    auto& samples = tracks[node.name];
    out.push_back(samples.empty() ? std::nullopt : std::optional(PoseTrack(std::move(samples))));
  }
  return out;
}

}  // namespace

RunFolder RunFolder::open(const fs::path& root, const Options& options) {
  RunFolder run;
  run.root_ = canonical_folder(root);
  const fs::path camera = member(run.root_, "camera.yaml");
  const CameraInfo left = read_camera_info(camera);
  if (left.T_left_right)
    throw InputError(camera.string(), "T_left_right says where the right camera is", "move it to camera_right.yaml");
  run.lens_left_ = left.lens;

  const PoseTrack track = read_trajectory(member(run.root_, "trajectory.txt"));
  std::vector<ListedImage> images = read_images(run.root_, member(run.root_, "rgb.txt"));
  for (ListedImage& listed : images) {
    place(listed, track, Pose::Identity(), images.back().image.time);
    run.frames_.push_back({std::move(listed.image), std::nullopt});
  }

  if (has_member(run.root_, "camera_right.yaml") || has_member(run.root_, "rgb_right.txt")) {
    const fs::path camera_right = member(run.root_, "camera_right.yaml");
    const CameraInfo right = read_camera_info(camera_right);
    if (!right.T_left_right)
      throw InputError(camera_right.string() + ": T_left_right", "is missing",
                       "add T_left_right: {xyz: [x, y, z], quaternion: [x, y, z, w]}");
    run.lens_right_ = right.lens;
    run.T_left_right_ = *right.T_left_right;
    run.unpaired_right_ =
        pair_images(run.frames_, read_images(run.root_, member(run.root_, "rgb_right.txt")), track, run.T_left_right_);
  }

  if (has_member(run.root_, "registration.txt"))
    read_predicted_errors(member(run.root_, "registration.txt"), run.frames_);

  run.scene_ = read_model(run.root_, options);
  if (has_member(run.root_, "nodes.txt"))
    run.node_tracks_ = read_node_tracks(member(run.root_, "nodes.txt"), *run.scene_);
  else
    run.node_tracks_.resize(run.scene_->nodes().size());
  return run;
}

SceneState RunFolder::state_at(RobotTime time, Duration exact) const {
  SceneState state{time, StateStatus::exact, {}};
  const auto& nodes = scene_->nodes();
  state.T_world_node.reserve(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Node& node = nodes[i];
    if (!node_tracks_[i]) {
      state.T_world_node.push_back(node.parent < 0 ? node.T_parent_node
                                                   : state.T_world_node[static_cast<std::size_t>(node.parent)] *
                                                         node.T_parent_node);
      continue;
    }
    PoseTrack::Answer answer = node_tracks_[i]->at(time, exact);
    if (answer.status == StateStatus::invalid) answer = {node_tracks_[i]->nearest(time).pose, StateStatus::predicted};
    state.status = std::max(state.status, answer.status);  // the enumeration goes from best to worst
    state.T_world_node.push_back(answer.pose);
  }
  return state;
}

}  // namespace foresight
