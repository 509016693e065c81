#include "calibration/formats/camera_formats.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "calibration/formats/lens_coefficients.hpp"
#include "calibration/formats/rectification.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/exact_number.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

struct Format {
  CameraFormat format;
  const char* name;
  std::size_t most;  // coefficients of a perspective lens
  bool fish_eye;
  bool sizes_may_differ;
};
constexpr std::array<Format, 4> kFormats{{{CameraFormat::camera_info, "camera-info", 8, true, true},
                                          {CameraFormat::kalibr, "kalibr", 4, true, true},
                                          {CameraFormat::opencv, "opencv", 12, true, false},
                                          {CameraFormat::mrcal, "mrcal", 12, false, true}}};

const Format& of(CameraFormat format) {
  return kFormats[static_cast<std::size_t>(format)];
}

bool can_hold(const Format& format, const CameraModel& camera) {
  if (camera.distortion == Distortion::equidistant) return format.fish_eye;
  return std::all_of(camera.lens.begin() + 4 + static_cast<std::ptrdiff_t>(format.most), camera.lens.end(),
                     [](double c) { return c == 0; });
}

bool can_hold(const Format& format, const CalibratedCameras& cameras) {
  if (!cameras.pair()) return can_hold(format, cameras.left());
  return can_hold(format, cameras.left()) && can_hold(format, cameras.right()) &&
         (can_be_rectified(cameras) || format.sizes_may_differ);
}

void require_held(CameraFormat format, const CalibratedCameras& cameras) {
  if (can_hold(of(format), cameras)) return;
  std::string others;
  for (const Format& other : kFormats)
    if (can_hold(other, cameras)) others += (others.empty() ? "" : " or ") + std::string(other.name);
  const std::string models =
      to_string(cameras.left().distortion) + (cameras.pair() ? " and " + to_string(cameras.right().distortion) : "");
  throw InputError("--to " + to_string(format),
                   "this format cannot hold " + models + " of these sizes and coefficients",
                   others.empty() ? "export the cameras one by one" : "use --to " + others);
}

// The folder goes with this.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "foresight-export-XXXXXX").string();
    if (!::mkdtemp(pattern.data()))
      throw RuntimeFailure("cannot make a folder in " + fs::temp_directory_path().string(),
                           "set TMPDIR to another one");
    path_ = pattern;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// Evenly over the unit square (Roberts' R2 sequence).
Eigen::Vector2d spread(int i) {
  constexpr double kPlastic = 1.32471795724474602596;
  const auto share = [i](double step) { return std::fmod(0.5 + step * i, 1.0); };
  return {share(1 / kPlastic), share(1 / (kPlastic * kPlastic))};
}

// Direction, of length 1 in depth or as a whole, that `camera` sees about at that share of its image: lens
// distortion aside.
Eigen::Vector3d direction(const CameraModel& camera, const Eigen::Vector2d& share) {
  const LensParameters& l = camera.lens;
  const Eigen::Vector2d n((share.x() * camera.width - l[2]) / l[0], (share.y() * camera.height - l[3]) / l[1]);
  if (camera.distortion != Distortion::equidistant || n.norm() < 1e-12) return {n.x(), n.y(), 1};
  const double angle = std::min(n.norm(), 0.99 * std::numbers::pi);
  return {std::sin(angle) * n.x() / n.norm(), std::sin(angle) * n.y() / n.norm(), std::cos(angle)};
}

bool same_size(const CameraModel& a, const CameraModel& b) {
  return a.width == b.width && a.height == b.height;
}

double distance(const CameraModel& a, const CameraModel& b, const Eigen::Vector3d& p_a, const Eigen::Vector3d& p_b) {
  Eigen::Vector2d pixel_a, pixel_b;
  const bool seen_a = project(a.distortion, a.lens.data(), p_a, pixel_a);
  const bool seen_b = project(b.distortion, b.lens.data(), p_b, pixel_b);
  if (!seen_a && !seen_b) return 0;
  const double d = seen_a && seen_b ? (pixel_a - pixel_b).norm() : INFINITY;
  return std::isnan(d) ? INFINITY : d;
}

}  // namespace

std::string to_string(CameraFormat format) {
  return of(format).name;
}

CameraFormat parse_camera_format(std::string_view name) {
  std::vector<std::string> names;
  for (const Format& format : kFormats) {
    if (name == format.name) return format.format;
    names.emplace_back(format.name);
  }
  throw InputError("format", "there is no camera format " + in_quotes(name), did_you_mean(name, names));
}

CalibratedCameras read_cameras(CameraFormat format, const fs::path& path) {
  switch (format) {
    case CameraFormat::camera_info: return formats::read_camera_info_files(path);
    case CameraFormat::kalibr: return formats::read_kalibr(path);
    case CameraFormat::opencv: return formats::read_opencv(path);
    default: return formats::read_mrcal(path);
  }
}

std::vector<CameraFileText> format_cameras(CameraFormat format, const CalibratedCameras& cameras,
                                           const fs::path& path) {
  require_held(format, cameras);
  switch (format) {
    case CameraFormat::camera_info: return formats::camera_info_text(cameras);
    case CameraFormat::kalibr: return formats::kalibr_text(cameras);
    case CameraFormat::opencv: return formats::opencv_text(cameras, path);
    default: return formats::mrcal_text(cameras);
  }
}

double worst_ray(const CalibratedCameras& a, const CalibratedCameras& b, int count) {
  if (!std::equal(a.cameras.begin(), a.cameras.end(), b.cameras.begin(), b.cameras.end(), same_size)) return INFINITY;
  double worst = 0;
  for (int i = 0; i < count; ++i) {
    const double depth = 0.3 * std::pow(10 / 0.3, (i + 0.5) / count);
    const Eigen::Vector3d p_left = depth * direction(a.left(), spread(i));
    worst = std::max(worst, distance(a.left(), b.left(), p_left, p_left));
    if (!a.pair()) continue;
    const Eigen::Vector3d p_right = depth * direction(a.right(), spread(i));
    worst =
        std::max(worst, distance(a.right(), b.right(), p_right, b.T_left_right.inverse() * (a.T_left_right * p_right)));
  }
  return worst;
}

ExportSummary write_cameras(CameraFormat format, const CalibratedCameras& cameras, const fs::path& path, bool replace) {
  if (fs::exists(path) && !replace)
    throw InputError(path.string(), "it exists", "write to another place, or give --force to replace it");
  const auto texts = format_cameras(format, cameras, path);
  const TemporaryFolder folder;
  const bool is_folder = texts.size() > 1;
  const std::string file_name = "cameras" + path.extension().string();
  for (const CameraFileText& t : texts) write_file_atomically(folder.path() / (is_folder ? t.name : file_name), t.text);
  ExportSummary summary;
  summary.rays = kRays;
  summary.worst_px =
      worst_ray(cameras, read_cameras(format, is_folder ? folder.path() : folder.path() / file_name), kRays);
  if (!(summary.worst_px <= kMostPx))
    throw RuntimeFailure("what " + to_string(format) + " would hold differs by " + exact_text(summary.worst_px) +
                             " px from the calibration",
                         "use another --to, and report this");
  if (is_folder) fs::create_directories(path);
  std::vector<FileContent> files;
  for (const CameraFileText& t : texts) {
    summary.files.push_back(is_folder ? path / t.name : path);
    files.push_back({summary.files.back(), t.text});
  }
  write_files_atomically(files);
  return summary;
}

}  // namespace foresight
