#include "scene/camera_info.hpp"

#include <algorithm>
#include <map>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/number_text.hpp"
#include "scene/scene_writer.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

const std::vector<std::string> kKeys = {"image_width",
                                        "image_height",
                                        "camera_name",
                                        "camera_matrix",
                                        "distortion_model",
                                        "distortion_coefficients",
                                        "rectification_matrix",
                                        "projection_matrix",
                                        "binning_x",
                                        "binning_y",
                                        "roi",
                                        "T_left_right"};

/// How many coefficients the model has, at most.
std::size_t coefficients_of(LensModel model) {
  switch (model) {
    case LensModel::plumb_bob: return 5;
    case LensModel::rational_polynomial: return 8;
    case LensModel::equidistant: return 4;
  }
  return 0;
}

LensModel read_model(const YamlMap& yaml) {
  // Names that other calibration tools use for one of the three.
  static const std::map<std::string, std::string> kOtherNames = {{"fisheye", "equidistant"},
                                                                 {"equi", "equidistant"},
                                                                 {"kannala_brandt", "equidistant"},
                                                                 {"kannala_brandt4", "equidistant"},
                                                                 {"radtan", "plumb_bob"},
                                                                 {"radial-tangential", "plumb_bob"},
                                                                 {"brown_conrady", "plumb_bob"},
                                                                 {"none", "plumb_bob"},
                                                                 {"pinhole", "plumb_bob"},
                                                                 {"opencv", "plumb_bob"},
                                                                 {"rational", "rational_polynomial"}};
  const std::string name = yaml.text("distortion_model");
  std::vector<std::string> known;
  for (LensModel model : {LensModel::plumb_bob, LensModel::rational_polynomial, LensModel::equidistant}) {
    known.push_back(to_string(model));
    if (name == known.back()) return model;
  }
  const auto other = kOtherNames.find(name);
  throw InputError(yaml.where("distortion_model"), "unknown model " + in_quotes(name),
                   did_you_mean(other != kOtherNames.end() ? other->second : name, known));
}

void read_matrix(const YamlMap& yaml, Lens::Parameters& p) {
  const std::string key = "camera_matrix";
  const auto k = yaml.numbers(key, 9);
  if (k[1] != 0) throw InputError(yaml.where(key), "the skew (second number) is not 0", "calibrate without skew");
  if (k[3] != 0 || k[6] != 0 || k[7] != 0 || k[8] != 1)
    throw InputError(yaml.where(key), "is not of the form [fx, 0, cx, 0, fy, cy, 0, 0, 1]", "write it so, row by row");
  if (!(k[0] > 0) || !(k[4] > 0))
    throw InputError(yaml.where(key), "the focal lengths fx and fy must be positive", "calibrate the camera");
  p.fx = k[0], p.cx = k[2], p.fy = k[4], p.cy = k[5];
}

void read_coefficients(const YamlMap& yaml, Lens::Parameters& p) {
  const std::string key = "distortion_coefficients";
  std::vector<double> d = yaml.numbers(key);
  const std::size_t given = d.size();
  const std::size_t most = coefficients_of(p.model);
  const std::size_t least = p.model == LensModel::plumb_bob ? 4 : most;
  // Zeros at the end say nothing, and a list of zeros means the same at every length.
  const bool zeros = std::all_of(d.begin(), d.end(), [](double c) { return c == 0; });
  while (d.size() > most && d.back() == 0) d.pop_back();
  if (given == 0 || d.size() > most || (d.size() < least && !zeros))
    throw InputError(yaml.where(key), "has " + std::to_string(given) + " numbers",
                     to_string(p.model) + " takes " + (least < most ? std::to_string(least) + " or " : "") +
                         std::to_string(most) + "; write as many, or another distortion_model");
  std::copy(d.begin(), d.end(), p.d.begin());
}

/// Share of the picture's pixels that see anything: where the model folds back before them, they see nothing.
double seen_share(const Lens& lens) {
  constexpr int kSamples = 32;  // along each side
  int seen = 0;
  for (int y = 0; y < kSamples; ++y)
    for (int x = 0; x < kSamples; ++x)
      seen += lens.unproject({(x + 0.5) / kSamples * lens.width() - 0.5, (y + 0.5) / kSamples * lens.height() - 0.5})
                  .has_value();
  return seen / static_cast<double>(kSamples * kSamples);
}

// The round picture of a fisheye fills less than half of a wide sensor.
constexpr double kLeastSeen = 0.25;

void require_mostly_unfolded(const YamlMap& yaml, const Lens& lens) {
  const double seen = seen_share(lens);
  if (seen < kLeastSeen)
    throw InputError(yaml.where("distortion_coefficients"),
                     "they fold the lens back inside of the picture: only " + readable(100 * seen, 0) +
                         " % of its pixels would see anything",
                     "correct them, their order (k1, k2, p1, p2, k3, ...), or camera_matrix");
}

// What would make the images something else than the raw ones that the calibration speaks of.
void refuse_reduced_images(const YamlMap& yaml, const Lens::Parameters& p) {
  for (const std::string key : {"binning_x", "binning_y"}) {
    if (!yaml.has(key)) continue;
    const int binning = yaml.integer(key);
    if (binning != 0 && binning != 1)
      throw InputError(yaml.where(key), "binned images are not supported",
                       "write the camera_matrix of the binned image and " + key + ": 1");
  }
  if (!yaml.has("roi")) return;
  const YamlMap roi = yaml.map("roi");
  roi.require_known({"x_offset", "y_offset", "width", "height", "do_rectify"});
  const auto value = [&](const char* key) { return roi.has(key) ? roi.integer(key) : 0; };
  const bool whole = value("x_offset") == 0 && value("y_offset") == 0 &&
                     (value("width") == 0 || value("width") == p.width) &&
                     (value("height") == 0 || value("height") == p.height);
  if (!whole)
    throw InputError(yaml.where("roi"), "a region of interest is not supported",
                     "write the camera_matrix and image size of the region, and remove roi");
}

}  // namespace

CameraInfo read_camera_info(const std::filesystem::path& file) {
  const YamlMap yaml = YamlMap::load(file);
  yaml.require_known(kKeys);
  Lens::Parameters p;
  p.width = yaml.integer("image_width");
  p.height = yaml.integer("image_height");
  p.model = read_model(yaml);
  read_matrix(yaml, p);
  read_coefficients(yaml, p);
  refuse_reduced_images(yaml, p);
  CameraInfo info;
  try {
    info.lens = Lens(p);
  } catch (const std::invalid_argument& error) {  // names the field, such as the image size
    throw InputError(file.string(), error.what(), "correct the calibration");
  }
  require_mostly_unfolded(yaml, info.lens);
  if (yaml.has("T_left_right")) info.T_left_right = yaml.pose("T_left_right");
  return info;
}

std::string camera_info_text(const CameraInfo& camera, const std::string& name) {
  const auto& p = camera.lens.parameters();
  const auto exact = [](double value) { return number_text(value, 17); };
  const std::size_t count = coefficients_of(p.model);
  std::string coefficients;
  for (std::size_t i = 0; i < count; ++i) coefficients += (i ? ", " : "") + exact(p.d[i]);
  std::string text =
      "image_width: " + std::to_string(p.width) + "\nimage_height: " + std::to_string(p.height) +
      "\ncamera_name: " + name + "\ncamera_matrix:\n  rows: 3\n  cols: 3\n  data: [" + exact(p.fx) + ", 0, " +
      exact(p.cx) + ", 0, " + exact(p.fy) + ", " + exact(p.cy) + ", 0, 0, 1]\ndistortion_model: " + to_string(p.model) +
      "\ndistortion_coefficients:\n  rows: 1\n  cols: " + std::to_string(count) + "\n  data: [" + coefficients + "]\n";
  if (camera.T_left_right) text += "T_left_right: " + pose_yaml(*camera.T_left_right) + "\n";
  return text;
}

}  // namespace foresight
