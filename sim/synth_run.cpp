#include "sim/synth_run.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>

#include "common/error.hpp"
#include "common/parallel.hpp"
#include "pictures/encode.hpp"
#include "scene/files.hpp"
#include "scene/run_writer.hpp"
#include "scene/scene_reader.hpp"
#include "scene/target_folder.hpp"
#include "sim/head_path.hpp"
#include "sim/motion.hpp"
#include "sim/polygons.hpp"
#include "sim/pose_error.hpp"
#include "sim/run_files.hpp"

namespace foresight::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarker = "synth.yaml";  // tells our folders from those of others
constexpr const char* kMarkerLine = "generator: foresight synth";
constexpr double kDepthUnit = 1e-4;  // metres
constexpr int kMeterSide = 64;       // px, of the longer side of the pictures that are metered

std::string image_name(bool right, int frame) {
  return RunWriter::image_name(right, static_cast<std::uint64_t>(frame));
}

void write_png(const fs::path& file, const cv::Mat& image) {
  const std::vector<std::uint8_t> bytes = encode_png(image);
  write_bytes(file, bytes.data(), bytes.size());
}

// One run while it is written.
class SynthRun {
 public:
  SynthRun(const fs::path& out, const SynthOptions& options)
      : options_(options),
        target_(out, synth_run_form()),
        // Finer pictures and light for finer images, so that a small test is quick and a large image sharp.
        relative_(640.0 / std::max(options.width, options.height)) {
    options_.sensor.seed = options.seed;
    const double pixels = 1.0 * options.width * options.height * options.frames * (options.stereo ? 2 : 1);
    target_.require_space(0.5 * pixels);
    if (options.head_path) head_path_.emplace(*options.head_path, time(options.frames - 1));
    for (int eye = 0; eye <= int{options.stereo}; ++eye) lenses_.push_back(synth_lens(options, eye == 1));
  }

  SynthSummary write(const std::function<void(int, int)>& progress, const std::function<void()>& begins) {
    try {
      return write_all(progress, begins);
    } catch (const fs::filesystem_error& e) {
      throw RuntimeFailure("cannot write " + target_.target().string() + " (" + e.code().message() + ")",
                           "free some disk space");
    }
  }

 private:
  double time(int frame) const { return frame / options_.rate; }
  static RobotTime at(double t) { return RobotTime{} + seconds(t); }
  fs::path truth_folder(bool right) const { return target_.path() / (right ? "truth_right" : "truth"); }
  LabState lab_state(const Lab& lab, double t) const {
    return lab_state_at(lab, options_.still ? 0 : t, options_.motion);
  }

  // Of pose errors, from image to image.
  double persistence() const {
    return options_.pose_error_s > 0 ? std::exp(-1 / (options_.rate * options_.pose_error_s)) : 0;
  }

  Pose T_world_left(double t) const { return head_path_ ? head_path_->at(t) : T_world_camera_at(t); }
  Pose T_world_eye(double t, bool right) const {
    return right ? Pose(T_world_left(t) * T_left_right()) : T_world_left(t);
  }

  SynthSummary write_all(const std::function<void(int, int)>& progress, const std::function<void()>& begins) {
    Lab lab = make_lab(0.0005 * std::clamp(relative_, 0.6, 8.0), options_.seed);
    for (Material& material : lab.materials)
      material.gloss = std::max(material.gloss, static_cast<float>(options_.gloss));
    if (head_path_) check_head(lab);
    const int images = options_.frames * static_cast<int>(lenses_.size());
    std::mutex mutex;
    const std::function<void()> poll = [&] {
      const std::scoped_lock lock(mutex);
      if (progress) progress(done_, images);
    };
    const LightMap light(lab, std::clamp(relative_, 0.6, 16.0), poll);
    const Renderer renderer(lab, light, poll);
    if (begins) begins();
    RunWriter run(target_.path(), lenses_[0], "synth_left");
    if (options_.stereo) run.add_right_camera(lenses_[1], T_left_right(), "synth_right");
    write_scene(target_.path(), lab, arm_position_at(0));
    node_of_facet(lab);
    add_node_track(run, lab);
    for (int eye = 0; eye <= int{options_.stereo}; ++eye) add_images(run, eye == 1);
    const Polygons polygons = polygons_of(lab);
    const SynthSummary summary = write_images(run, renderer, polygons, poll);
    add_trajectory(run);
    run.flush();
    write_marker(summary);
    target_.commit();
    return summary;
  }

  void check_head(const Lab& lab) const {
    const RoomCheck room(lab);
    for (int i = 0; i < options_.frames; ++i)
      for (int eye = 0; eye <= int{options_.stereo}; ++eye) {
        const double t = time(i);
        const std::string fault = room.fault(T_world_eye(t, eye == 1).translation(), lab_state(lab, t));
        if (!fault.empty())
          throw InputError(options_.head_path->string(),
                           fmt::format("at {:.3f} s the {} camera ", t, eye ? "right" : "left") + fault,
                           "lead the path through the free space of the lab");
      }
  }

  // As the reader will number the nodes, whatever the order of its robots' links is.
  void node_of_facet(const Lab& lab) {
    const SceneModel scene = read_scene(target_.path() / "scene.yaml", target_.path());
    node_count_ = static_cast<int>(scene.nodes().size());
    for (const Part& part : lab.parts) node_.insert(node_.end(), part.facets.size(), scene.find(part.name).value());
  }

  // Instants of tracks: all images, and between and around them enough for exposures of any row.
  std::vector<double> track_times() const {
    const int steps = static_cast<int>(std::ceil(kNodeRate / options_.rate));
    const double margin = 0.5 * (options_.shutter.readout_s + options_.shutter.exposure_s);
    const int extra = static_cast<int>(std::ceil(margin * options_.rate * steps - 1e-9));
    std::vector<double> out;
    for (int i = -extra; i <= steps * (options_.frames - 1) + extra; ++i) out.push_back(i / (options_.rate * steps));
    return out;
  }

  void add_node_track(RunWriter& run, const Lab& lab) const {
    for (const double t : track_times()) {
      const LabState state = lab_state(lab, t);
      for (std::size_t k = 0; k < lab.parts.size(); ++k)
        if (lab.parts[k].moves) run.add_node(at(t), lab.parts[k].name, state[k]);
    }
  }

  void add_images(RunWriter& run, bool right) const {
    for (int i = 0; i < options_.frames; ++i) run.add_image(right, at(time(i)), image_name(right, i));
    if (!options_.truth) return;
    const fs::path truth = truth_folder(right);
    for (const char* kind : {"depth", "node"}) fs::create_directories(truth / kind);
    std::string trajectory = "# time[s] tx ty tz[m] qx qy qz qw: true T_world_camera of this camera\n";
    for (const double t : track_times()) trajectory += time_text(at(t)) + " " + pose_text(T_world_eye(t, right)) + "\n";
    write_text(truth / "trajectory.txt", trajectory);
    write_text(truth / "truth.yaml", fmt::format("depth_unit_m: {:g}\nreadout_s: {:.9g}\nnodes: {}\n", kDepthUnit,
                                                 options_.shutter.readout_s, node_count_));
  }

  SynthSummary write_images(const RunWriter& run, const Renderer& renderer, const Polygons& polygons,
                            const std::function<void()>& poll) {
    std::mutex mutex;
    std::vector<RayTable> rays(lenses_.begin(), lenses_.end());
    meter(renderer);
    pose_errors_.assign(options_.frames, Pose::Identity());
    SynthSummary summary{polygons.count, polygons.count, 0};
    parallel_for(options_.frames, [&](std::size_t frame) {
      for (std::size_t eye = 0; eye < rays.size(); ++eye) {
        const int in_view = write_image(run, renderer, rays[eye], polygons, static_cast<int>(frame), eye == 1);
        ++done_;
        poll();
        const std::scoped_lock lock(mutex);
        summary.fewest_polygons_in_view = std::min(summary.fewest_polygons_in_view, in_view);
        summary.most_polygons_in_view = std::max(summary.most_polygons_in_view, in_view);
      }
    });
    return summary;
  }

  // What an exposure control would choose for each image: it meters small pictures of the same views.
  void meter(const Renderer& renderer) {
    exposure_.assign(static_cast<std::size_t>(options_.frames), 1);
    if (!options_.auto_exposure) return;
    SynthOptions small = options_;
    small.width = std::max(16, options_.width * kMeterSide / std::max(options_.width, options_.height));
    small.height = std::max(16, options_.height * kMeterSide / std::max(options_.width, options_.height));
    const RayTable rays(synth_lens(small, false));
    std::vector<cv::Mat> light(exposure_.size());
    parallel_for(options_.frames, [&](std::size_t frame) {
      const double t = time(static_cast<int>(frame));
      const LabState state = lab_state(renderer.lab(), t);
      light[frame] = renderer.render(rays, T_world_left(t), state, renderer.light().lit(state)).light;
    });
    Sensor sensor = options_.sensor;
    sensor.blur = sensor.noise = 0;
    exposure_ = run_auto_exposure(*options_.auto_exposure, options_.frames, [&](int image, double factor) {
      const cv::Scalar mean = cv::mean(sensor.develop(light[static_cast<std::size_t>(image)], time(image), 0, factor));
      return (0.114 * mean[0] + 0.587 * mean[1] + 0.299 * mean[2]) / 255;
    });
  }

  // Returns the number of polygons in view.
  int write_image(const RunWriter& run, const Renderer& renderer, const RayTable& rays, const Polygons& polygons,
                  int frame, bool right) {
    const double t = time(frame);
    const LabMotion motion{[&](double at) { return T_world_eye(at, right); },
                           [&](double at) { return lab_state(renderer.lab(), at); }};
    const Picture picture = expose(renderer, rays, motion, options_.shutter, t);
    run.write_image(image_name(right, frame),
                    options_.sensor.develop(picture.light, t, 2 * static_cast<std::uint64_t>(frame) + right,
                                            exposure_[static_cast<std::size_t>(frame)]));
    if (!right)
      pose_errors_[static_cast<std::size_t>(frame)] =
          random_pose_error(lenses_[0], picture.depth, options_.pose_error_px, options_.seed, frame, persistence());
    cv::Mat depth(picture.depth.size(), CV_16UC1), node(picture.depth.size(), CV_16UC1);
    std::vector<std::uint8_t> seen(static_cast<std::size_t>(polygons.count), 0);
    for (int v = 0; v < depth.rows; ++v)
      for (int u = 0; u < depth.cols; ++u) {
        const int facet = picture.facet.at<int>(v, u);
        const double steps = picture.depth.at<float>(v, u) / kDepthUnit;
        const bool stored = facet >= 0 && steps < 65535;
        depth.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(stored ? std::lround(steps) : 0);
        node.at<std::uint16_t>(v, u) =
            static_cast<std::uint16_t>(stored ? node_[static_cast<std::size_t>(facet)] + 1 : 0);
        if (facet >= 0) seen[static_cast<std::size_t>(polygons.of_facet[static_cast<std::size_t>(facet)])] = 1;
      }
    if (options_.truth) {
      const std::string file = fs::path(image_name(false, frame)).filename();
      write_png(truth_folder(right) / "depth" / file, depth);
      write_png(truth_folder(right) / "node" / file, node);
    }
    return static_cast<int>(std::count(seen.begin(), seen.end(), 1));
  }

  void add_trajectory(RunWriter& run) const {
    for (int i = 0; i < options_.frames; ++i)
      run.add_pose(at(time(i)), T_world_left(time(i)) * pose_errors_[static_cast<std::size_t>(i)]);
  }

  void write_marker(const SynthSummary& summary) const {
    const auto& o = options_;
    std::string text = fmt::format("{}\n", kMarkerLine);
    text += fmt::format("size: [{}, {}]\nframes: {}\nrate_hz: {:.9g}\nstereo: {}\nlens: {}\nseed: {}\n", o.width,
                        o.height, o.frames, o.rate, o.stereo ? "true" : "false",
                        o.fisheye ? "fisheye" : (o.distortion ? "distorted" : "pinhole"), o.seed);
    text += fmt::format(
        "blur_px: {:.9g}\nnoise: {:.9g}\nexposure_drift: {:.9g}\nvignetting: {:.9g}\nexposure_s: {:.9g}\nreadout_s: "
        "{:.9g}\n",
        o.sensor.blur, o.sensor.noise, o.sensor.exposure_drift, o.sensor.vignetting, o.shutter.exposure_s,
        o.shutter.readout_s);
    text += fmt::format("pose_error_px: {:.9g}\npose_error_s: {:.9g}\nhead_path: {}\n", o.pose_error_px, o.pose_error_s,
                        o.head_path ? "given" : "built in");
    text += fmt::format("exposure: {:.9g}\nauto_exposure: {}\nstill: {}\n", o.sensor.exposure,
                        o.auto_exposure ? "true" : "false", o.still ? "true" : "false");
    if (o.motion != 0) text += fmt::format("motion: {}\n", o.motion);
    if (o.gloss != 0) text += fmt::format("gloss: {:.9g}\n", o.gloss);
    text += fmt::format("polygons: {}\npolygons_in_view: [{}, {}]\n", summary.polygons, summary.fewest_polygons_in_view,
                        summary.most_polygons_in_view);
    write_text(target_.path() / kMarker, text);
  }

  SynthOptions options_;
  TargetFolder target_;
  double relative_;
  std::atomic<int> done_ = 0;  // images
  std::optional<HeadPath> head_path_;
  std::vector<Lens> lenses_;
  std::vector<int> node_;  // of each facet
  int node_count_ = 0;
  std::vector<Pose> pose_errors_;
  std::vector<double> exposure_;  // factor on the light of each image
};

}  // namespace

FolderForm synth_run_form() {
  return {kMarker, kMarkerLine, [](const fs::path& relative) {
            if (relative == kMarker || relative == "arm.urdf" || is_file_of_run(relative)) return true;
            const std::string top = relative.empty() ? "" : relative.begin()->string();
            if (top != "truth" && top != "truth_right") return false;
            const fs::path inside = relative.lexically_relative(top);
            if (inside == "trajectory.txt" || inside == "truth.yaml") return true;
            const fs::path kind = inside.parent_path();
            return (kind == "depth" || kind == "node") && is_file_of_run("rgb" / inside.filename());
          }};
}

void check(const SynthOptions& o) {
  const auto range = [](const char* option, const char* what, double value, double low, double high) {
    if (!(value >= low && value <= high))
      throw InputError(option, fmt::format("{}{:.9g} is outside {:.9g} .. {:.9g}", what, value, low, high),
                       "choose a value inside");
  };
  range("--size", "a width of ", o.width, 16, 8192);
  range("--size", "a height of ", o.height, 16, 8192);
  range("--frames", "", o.frames, 1, 1'000'000);
  range("--rate", "", o.rate, 0.1, 1000);
  range("--blur", "", o.sensor.blur, 0, 10);
  range("--noise", "", o.sensor.noise, 0, 100);
  range("--exposure", "", o.sensor.exposure, 0.1, 10);
  range("--exposure-drift", "", o.sensor.exposure_drift, 0, 0.9);
  range("--vignetting", "", o.sensor.vignetting, 0, 0.9);
  range("--gloss", "", o.gloss, 0, 1);
  range("--motion-blur", "", o.shutter.exposure_s * 1e3, 0, 1000);
  range("--rolling-shutter", "", o.shutter.readout_s * 1e3, 0, 1000);
  range("--pose-error-px", "", o.pose_error_px, 0, 100);
  range("--pose-error-s", "", o.pose_error_s, 0, 60);
}

Lens synth_lens(const SynthOptions& options, bool right) {
  Lens::Parameters p;
  p.width = options.width;
  p.height = options.height;
  // In units of the longer side, so that all sizes see the same.
  const double unit = std::max(options.width, options.height) / 640.0;
  p.fx = (right ? 523.4 : 521.6) * unit;
  p.fy = (right ? 523.9 : 522.3) * unit;
  p.cx = (p.width - 1) / 2.0 + (right ? -2.9 : 3.7) * unit;
  p.cy = (p.height - 1) / 2.0 + (right ? 2.2 : -4.1) * unit;
  if (options.fisheye) {
    // 150 degrees along the diagonal: too wide for any one pinhole picture.
    p.model = LensModel::equidistant;
    p.fx = p.fy = 305.0 * unit;
    p.d = {-0.012, 0.003, -0.0006, 0.0};
  } else if (options.distortion) {
    p.d = right ? std::array<double, 8>{-0.276, 0.087, -0.0004, 0.0007}
                : std::array<double, 8>{-0.28, 0.09, 0.0006, -0.0005};
  }
  return Lens(p);
}

SynthSummary write_synth_run(const fs::path& out, const SynthOptions& options,
                             const std::function<void(int, int)>& progress, const std::function<void()>& begins) {
  check(options);
  return SynthRun(out, options).write(progress, begins);
}

}  // namespace foresight::sim
