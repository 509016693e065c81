#include "scene/ground_truth.hpp"

#include "common/error.hpp"
#include "pictures/decode.hpp"
#include "pictures/image_structure.hpp"
#include "scene/files.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace fs = std::filesystem;
namespace {

constexpr const char* kCure = "make the run again with `foresight synth`";

const char* folder_name(bool right) {
  return right ? "truth_right" : "truth";
}

cv::Mat read_plane(const fs::path& file, const Lens& lens) {
  const std::string bytes = read_file(file);
  const ImageForm form = read_image_form(bytes, file);
  if (form.bits != 16 || form.channels != 1 || form.has_alpha)
    throw InputError(file.string(), "is not a 16-bit grey PNG", kCure);
  if (form.width != lens.width() || form.height != lens.height())
    throw InputError(file.string(),
                     "is " + std::to_string(form.width) + "x" + std::to_string(form.height) +
                         ", the camera's images are " + std::to_string(lens.width()) + "x" +
                         std::to_string(lens.height()),
                     kCure);
  const cv::Mat out = decode_picture(bytes, PictureColours::as_stored).pixels;
  if (out.type() != CV_16UC1) throw InputError(file.string(), "cannot be decoded", kCure);
  return out;
}

}  // namespace

bool GroundTruth::exists(const RunFolder& run) {
  std::error_code error;
  return fs::exists(fs::symlink_status(run.root() / folder_name(false), error));
}

GroundTruth GroundTruth::open(const RunFolder& run) {
  GroundTruth out(run);
  out.left_ = open_camera(run, false);
  std::error_code error;
  if (run.lens_right() && fs::exists(run.root() / folder_name(true), error)) out.right_ = open_camera(run, true);
  return out;
}

GroundTruth::Camera GroundTruth::open_camera(const RunFolder& run, bool right) {
  Camera out;
  out.folder = run.root() / folder_name(right);
  const fs::path file = out.folder / "truth.yaml";
  require_regular_file(file);
  const YamlMap yaml = YamlMap::load(file);
  yaml.require_known({"depth_unit_m", "readout_s", "nodes"});
  out.unit = yaml.number("depth_unit_m");
  if (!(out.unit > 0 && out.unit <= 0.1))
    throw InputError(yaml.where("depth_unit_m"), "a depth unit of " + std::to_string(out.unit) + " m", kCure);
  const double readout = yaml.number("readout_s");
  if (!(readout >= 0 && readout <= 1))
    throw InputError(yaml.where("readout_s"), "a readout of " + std::to_string(readout) + " s", kCure);
  out.readout = seconds(readout);
  const std::size_t nodes = run.scene()->nodes().size();
  if (yaml.integer("nodes") != static_cast<int>(nodes))
    throw InputError(yaml.where("nodes"),
                     "the truth speaks of " + std::to_string(yaml.integer("nodes")) + " nodes, the scene has " +
                         std::to_string(nodes),
                     "open the run with the scene it was made with");
  out.track = read_trajectory(out.folder / "trajectory.txt");
  return out;
}

const GroundTruth::Camera& GroundTruth::camera(bool right) const {
  if (!right) return left_;
  if (!right_) throw InputError((run_->root() / folder_name(true)).string(), "is missing", kCure);
  return *right_;
}

const RunImage& GroundTruth::image(std::size_t frame, bool right) const {
  const RunFrame& both = run_->frames().at(frame);
  if (!right) return both.left;
  if (!both.right)
    throw InputError((run_->root() / "rgb_right.txt").string(),
                     "has no image that belongs to " + both.left.file.filename().string(), kCure);
  return *both.right;
}

Pose GroundTruth::pose_at(const Camera& camera, RobotTime time) const {
  const PoseTrack::Answer answer = camera.track.at(time, Duration{0});
  if (answer.status == StateStatus::invalid)
    throw InputError((camera.folder / "trajectory.txt").string(),
                     "has no pose at " + std::to_string(to_seconds(time - RobotTime{})) + " s", kCure);
  return answer.pose;
}

Pose GroundTruth::T_world_camera(std::size_t frame, bool right) const {
  return pose_at(camera(right), image(frame, right).time);
}

GroundTruth::Surface GroundTruth::read(std::size_t frame, bool right) const {
  const Camera& from = camera(right);
  const RunImage& of = image(frame, right);
  Surface out;
  out.lens_ = right ? *run_->lens_right() : run_->lens_left();
  out.unit_ = from.unit;
  const fs::path depth = from.folder / "depth" / (of.stem + ".png"), node = from.folder / "node" / (of.stem + ".png");
  out.depth_ = read_plane(depth, out.lens_);
  out.node_ = read_plane(node, out.lens_);
  const std::size_t nodes = run_->scene()->nodes().size();
  for (int v = 0; v < out.height(); ++v)
    for (int u = 0; u < out.width(); ++u) {
      const int number = out.node_.at<std::uint16_t>(v, u);
      if (number > static_cast<int>(nodes) || (number == 0) != (out.depth_.at<std::uint16_t>(v, u) == 0))
        throw InputError(node.string(),
                         "pixel (" + std::to_string(u) + ", " + std::to_string(v) + ") is of node " +
                             std::to_string(number - 1) + ", which does not fit the scene or the depth",
                         kCure);
    }
  const int rows = from.readout > Duration{0} ? out.height() : 1;
  for (int row = 0; row < rows; ++row) {
    // The image's time is that of its centre row.
    const double away = rows > 1 ? (row - (rows - 1) / 2.0) / (rows - 1) : 0;
    const RobotTime time = of.time + seconds(away * to_seconds(from.readout));
    const Pose T_world_camera = pose_at(from, time);
    std::vector<Pose>& T_node_camera = out.T_node_camera_.emplace_back();
    for (const Pose& T_world_node : run_->state_at(time, Duration{0}).T_world_node)
      T_node_camera.push_back(T_world_node.inverse() * T_world_camera);
  }
  return out;
}

std::optional<GroundTruth::Point> GroundTruth::Surface::at(int u, int v) const {
  const int node = node_.at<std::uint16_t>(v, u) - 1;
  const auto ray = lens_.unproject({u, v});
  if (node < 0 || !ray) return std::nullopt;
  const auto& T_node_camera = T_node_camera_[T_node_camera_.size() > 1 ? static_cast<std::size_t>(v) : 0];
  return Point{node, T_node_camera[static_cast<std::size_t>(node)] * (*ray * (depth(u, v) / ray->z()))};
}

}  // namespace foresight
