// What a replay measured: one record per image, one per run, their summary, and the JSON file.
//
// Plain values; no threads. A quantity that could not be measured is an empty optional or NaN;
// both become null in JSON.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pictures/image_metrics.hpp"

namespace foresight {

/// What was not measured.
inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// What a stage works for. Only `texture` counts as the cost of turning images into textures.
enum class StagePart {
  texture,  ///< from the raw image to the published textures
  view,     ///< rendering the predicted view
  measure,  ///< reading back, comparing, writing pictures
};

struct StageTime {
  std::string name;              ///< such as "extract"
  double cpu_ms = 0;             ///< CPU time of all threads
  std::optional<double> gpu_ms;  ///< timer query; empty where there is no GPU to time
  StagePart part = StagePart::texture;
};

/// One image time of the run.
struct FrameRecord {
  std::string stem;        ///< file name of the image without folder and extension
  double time_s = 0;       ///< capture instant, clock of the run
  double delay_s = 0;      ///< age of `delayed`: the newest image that was available at time_s
  ImageQuality predicted;  ///< the predicted view against the actual image, on the seen pixels
  ImageQuality delayed;    ///< the newest available image against it, on the same pixels
  Coverage coverage;
  std::vector<StageTime> stages;                ///< in the order in which they run
  std::optional<double> arrival_to_publish_ms;  ///< of the newest image; empty if none arrived
  /// From the arrival of the newest image to the end of the first drawing that shows it, and CPU time of all threads
  /// in between; empty if none arrived, and in real time.
  std::optional<double> arrival_to_visible_ms, arrival_to_visible_cpu_ms;
  /// To the textures, of images that were finished since the image time before; empty if none was.
  std::optional<double> texels_written;
  std::uint64_t texture_bytes_used = 0;
  std::uint64_t texture_bytes_budget = 0;
  double gain = 1;  ///< exposure gain that was applied to the newest image, linear light
  /// How far images lie beside what was there before, along each axis; empty as long as it is not known.
  std::optional<double> misplacement_px;
  bool dropped = false;  ///< the image was not shown in time (--real-time); no quality, no coverage
};

struct OptionRecord {
  std::string name;  ///< snake_case with its unit, such as "margin_px"
  std::variant<bool, std::int64_t, double, std::string> value;
};

/// What `replay --refine` did, in images.
struct RefinementRecord {
  std::uint64_t refined = 0;    ///< at a refined pose
  std::uint64_t refused = 0;    ///< that could not be aligned: at their predicted pose
  std::uint64_t vetoed = 0;     ///< whose refined pose contradicted tags: at their given pose
  std::uint64_t with_tags = 0;  ///< refined or vetoed, with a tag of the run's tags.txt in sight
};

struct RunRecord {
  std::string run;  ///< name of the run folder
  int image_width_px = 0;
  int image_height_px = 0;
  int cameras = 1;
  std::string lens_model;  ///< ROS name
  std::uint64_t scene_triangles = 0;
  std::uint64_t degenerate_triangles = 0;  ///< dropped when the model was read
  std::uint64_t charts = 0;
  std::uint64_t texels = 0;       ///< of all charts together
  std::uint64_t images_kept = 0;  ///< at once, beside the textures (TextureOptions::images), at most
  std::vector<OptionRecord> options;
  std::string renderer;  ///< GL_RENDERER
  std::string version;   ///< of this program
  std::vector<FrameRecord> frames;
  std::uint64_t drops = 0;                     ///< images that never became textures
  std::vector<std::string> notes;              ///< full sentences, such as what the memory policy did
  std::optional<RefinementRecord> refinement;  ///< with --refine
  bool complete = true;                        ///< false after Ctrl-C
};

/// Of the finite values only; all NaN where there is none. `p99` and `median` interpolate linearly
/// between the two nearest ranks.
struct Statistic {
  double mean = std::numeric_limits<double>::quiet_NaN();
  double median = mean;
  double min = mean;
  double max = mean;
  double p99 = mean;
};

Statistic statistic_of(std::vector<double> values);

struct QualitySummary {
  Statistic psnr_db, ssim, sharpness;
};

struct StageSummary {
  std::string name;
  StagePart part = StagePart::texture;
  double cpu_ms = 0;             ///< mean over all frames; a frame without the stage counts as 0
  std::optional<double> gpu_ms;  ///< likewise
};

struct Summary {
  std::size_t frames = 0;  ///< without the dropped ones
  std::size_t dropped_frames = 0;
  QualitySummary predicted, delayed;
  Coverage coverage;                  ///< mean
  Statistic coloured_of_model;        ///< share of the model's pixels that have a colour
  std::vector<StageSummary> stages;   ///< in the order of their first appearance
  double texture_cpu_ms = 0;          ///< per image, StagePart::texture
  double texture_gpu_ms = 0;          ///< likewise; NaN without a timed GPU
  double images_per_core_second = 0;  ///< 1000 / texture_cpu_ms; NaN where nothing was timed
  Statistic arrival_to_publish_ms, arrival_to_visible_ms, arrival_to_visible_cpu_ms;
  Statistic texels_written;
  std::uint64_t texture_bytes_max = 0;
  std::uint64_t texture_bytes_budget = 0;
  double bytes_per_texel = 0;  ///< texture_bytes_max / texels; NaN without texels
};

Summary summarise(const RunRecord& run);

/// Schema version 1: keys in a fixed order, snake_case with units.
nlohmann::ordered_json to_json(const RunRecord& run);

/// Writes to_json() atomically. Throws RuntimeFailure naming `file` and the cure.
void write_json_report(const RunRecord& run, const std::filesystem::path& file);

/// "texture", "view", "measure".
std::string to_string(StagePart part);

}  // namespace foresight
