#include "sim/sample_run.hpp"

#include <unistd.h>

#include <cstdarg>
#include <cstdio>
#include <fstream>
#include <mutex>
#include <opencv2/imgcodecs.hpp>

#include "common/error.hpp"
#include "sim/lab.hpp"
#include "sim/light_map.hpp"
#include "sim/motion.hpp"
#include "sim/parallel.hpp"
#include "sim/picture.hpp"

namespace foresight::sim {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMarker = "sample.yaml";  // tells our folders from those of others
constexpr const char* kMarkerLine = "generator: foresight sample";

[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, pattern);
  std::vsnprintf(buffer, sizeof buffer, pattern, arguments);
  va_end(arguments);
  return buffer;
}

void write_bytes(const fs::path& file, const void* data, std::size_t size) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(static_cast<const char*>(data), static_cast<std::streamsize>(size));
  stream.close();
  if (!stream) throw RuntimeFailure("cannot write " + file.string(), "free some space on its disk");
}

void write_text(const fs::path& file, const std::string& text) {
  write_bytes(file, text.data(), text.size());
}

std::string numbers(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return format("%.12g %.12g %.12g %.15g %.15g %.15g %.15g", p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

std::string yaml(const Pose& pose) {
  const Eigen::Vector3d p = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  return format("{xyz: [%.12g, %.12g, %.12g], quaternion: [%.15g, %.15g, %.15g, %.15g]}", p.x(), p.y(), p.z(), q.x(),
                q.y(), q.z(), q.w());
}

std::string camera_yaml(const Lens& lens, bool right) {
  const auto& p = lens.parameters();
  std::string text = format("image_width: %d\nimage_height: %d\ncamera_name: sample_%s\n", p.width, p.height,
                            right ? "right" : "left");
  text += format("camera_matrix:\n  rows: 3\n  cols: 3\n  data: [%.17g, 0, %.17g, 0, %.17g, %.17g, 0, 0, 1]\n", p.fx,
                 p.cx, p.fy, p.cy);
  text += "distortion_model: " + to_string(p.model) + "\n";
  const int count = p.model == LensModel::equidistant ? 4 : 5;
  text += format("distortion_coefficients:\n  rows: 1\n  cols: %d\n  data: [%.17g", count, p.d[0]);
  for (int i = 1; i < count; ++i) text += format(", %.17g", p.d[static_cast<std::size_t>(i)]);
  text += "]\n";
  if (right) text += "T_left_right: " + yaml(T_left_right()) + "\n";
  return text;
}

std::string ply(const Mesh& mesh) {
  std::string text = "ply\nformat ascii 1.0\ncomment metres, in the frame of the node\n";
  text += format("element vertex %zu\nproperty float x\nproperty float y\nproperty float z\n", mesh.vertices.size());
  text += format("element face %zu\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.size());
  for (const auto& v : mesh.vertices) text += format("%.9g %.9g %.9g\n", v.x(), v.y(), v.z());
  for (const auto& t : mesh.triangles) text += format("3 %u %u %u\n", t[0], t[1], t[2]);
  return text;
}

std::string image_name(const char* folder, int frame) {
  return format("%s/%06d.png", folder, frame);
}

void write_scene(const fs::path& folder, const Lab& lab) {
  fs::create_directory(folder / "meshes");
  std::string text = "accuracy_m: 0.004  # the model is exact; this tells thin parts from what they lie on\nnodes:\n";
  for (const Part& part : lab.parts) {
    write_text(folder / "meshes" / (part.name + ".ply"), ply(mesh_of(part)));
    text += "  - name: " + part.name + "\n    mesh: meshes/" + part.name + ".ply\n";
    text += "    pose: " + yaml(part.T_world_part) + "\n";
  }
  write_text(folder / "scene.yaml", text);
}

void write_tracks(const fs::path& folder, const SampleRunOptions& options, const std::string& plate) {
  std::string trajectory = "# time[s] tx ty tz[m] qx qy qz qw: T_world_camera of the left camera\n";
  std::string nodes = "# time[s] node tx ty tz[m] qx qy qz qw: T_world_node\n";
  for (int i = 0; i < options.frames; ++i) {
    const double t = i / kSampleFrameRate;
    trajectory += format("%.9f ", t) + numbers(T_world_camera_at(t)) + "\n";
  }
  for (int i = 0; i <= kSamplePosesPerFrame * (options.frames - 1); ++i) {
    const double t = i / (kSampleFrameRate * kSamplePosesPerFrame);
    nodes += format("%.9f ", t) + plate + " " + numbers(T_world_plate_at(t)) + "\n";
  }
  write_text(folder / "trajectory.txt", trajectory);
  write_text(folder / "nodes.txt", nodes);
}

void write_camera(const fs::path& folder, const SampleRunOptions& options, bool right) {
  const char* images = right ? "rgb_right" : "rgb";
  fs::create_directory(folder / images);
  std::string list = "# time[s] file\n";
  for (int i = 0; i < options.frames; ++i) list += format("%.9f ", i / kSampleFrameRate) + image_name(images, i) + "\n";
  write_text(folder / (right ? "rgb_right.txt" : "rgb.txt"), list);
  write_text(folder / (right ? "camera_right.yaml" : "camera.yaml"), camera_yaml(sample_lens(options, right), right));
}

void write_images(const fs::path& folder, const SampleRunOptions& options, const Lab& lab,
                  const std::function<void(int, int)>& progress) {
  // Finer pictures and light for finer images, so that a small test is quick and a large image sharp.
  const double relative = 640.0 / std::max(options.width, options.height);
  std::mutex mutex;
  int done = 0;
  const int total = options.frames * (options.stereo ? 2 : 1);
  const LightMap light(lab, std::clamp(relative, 0.6, 16.0), [&] {
    const std::scoped_lock lock(mutex);
    if (progress) progress(0, total);
  });
  const Renderer renderer(lab, light);
  std::vector<RayTable> rays;
  for (int eye = 0; eye <= int{options.stereo}; ++eye) rays.emplace_back(sample_lens(options, eye == 1));

  parallel_for(options.frames, [&](std::size_t frame) {
    const double t = static_cast<double>(frame) / kSampleFrameRate;
    const Pose T_world_plate = T_world_plate_at(t);
    const auto irradiance = light.with_plate_at(T_world_plate);
    for (std::size_t eye = 0; eye < rays.size(); ++eye) {
      const Pose T_world_camera = eye ? Pose(T_world_camera_at(t) * T_left_right()) : T_world_camera_at(t);
      std::vector<std::uint8_t> bytes;
      cv::imencode(".png", renderer.render(rays[eye], T_world_camera, T_world_plate, irradiance), bytes);
      write_bytes(folder / image_name(eye ? "rgb_right" : "rgb", static_cast<int>(frame)), bytes.data(), bytes.size());
      const std::scoped_lock lock(mutex);
      ++done;
      if (progress) progress(done, total);
    }
  });
}

void check(const SampleRunOptions& options) {
  const auto range = [](const char* name, int value, int low, int high) {
    if (value < low || value > high)
      throw InputError(name, format("%d is outside %d .. %d", value, low, high), "choose a value inside");
  };
  range("width", options.width, 16, 8192);
  range("height", options.height, 16, 8192);
  range("frames", options.frames, 1, 1'000'000);
}

// Whether `out` may be replaced by us.
void check_target(const fs::path& out) {
  if (!fs::exists(fs::symlink_status(out))) return;
  if (fs::is_symlink(out) || !fs::is_directory(out))
    throw InputError(out.string(), "exists and is not a folder", "choose another place");
  if (fs::is_empty(out)) return;
  std::string line;
  std::ifstream marker(out / kMarker);
  if (!std::getline(marker, line) || line != kMarkerLine)
    throw InputError(out.string(), "is not empty and holds no sample run", "choose a new or empty folder");
}

}  // namespace

Lens sample_lens(const SampleRunOptions& options, bool right) {
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
  } else if (options.distortion)
    p.d = right ? std::array<double, 8>{-0.276, 0.087, -0.0004, 0.0007}
                : std::array<double, 8>{-0.28, 0.09, 0.0006, -0.0005};
  return Lens(p);
}

void write_sample_run(const fs::path& out, const SampleRunOptions& options,
                      const std::function<void(int, int)>& progress) {
  check(options);
  fs::path target = fs::absolute(out).lexically_normal();
  if (!target.has_filename()) target = target.parent_path();
  check_target(target);
  const fs::path partial = target.string() + format(".partial-%d", static_cast<int>(getpid()));
  try {
    fs::create_directories(target.parent_path());
    fs::create_directory(partial);
  } catch (const fs::filesystem_error& e) {
    throw InputError(out.string(), "cannot be written (" + e.code().message() + ")", "choose a writable place");
  }
  try {
    const Lab lab =
        make_lab(0.0005 * std::clamp(640.0 / std::max(options.width, options.height), 0.6, 8.0), options.seed);
    write_text(partial / kMarker,
               format("%s\nsize: [%d, %d]\nframes: %d\nstereo: %s\nfisheye: %s\ndistortion: %s\nseed: %u\n",
                      kMarkerLine, options.width, options.height, options.frames, options.stereo ? "true" : "false",
                      options.fisheye ? "true" : "false", options.distortion ? "true" : "false", options.seed));
    write_scene(partial, lab);
    write_tracks(partial, options, lab.parts[lab.plate].name);
    for (int eye = 0; eye <= int{options.stereo}; ++eye) write_camera(partial, options, eye == 1);
    write_images(partial, options, lab, progress);
    fs::remove_all(target);  // an earlier sample run, or an empty folder
    fs::rename(partial, target);
  } catch (const fs::filesystem_error& e) {
    fs::remove_all(partial);
    throw RuntimeFailure("cannot write " + target.string() + " (" + e.code().message() + ")",
                         "see that its disk has space");
  } catch (...) {
    fs::remove_all(partial);
    throw;
  }
}

}  // namespace foresight::sim
