// Writes synthetic runs: the lab with its moving arm, rendered here, so that poses, model and lens
// are exactly true, or wrong by what was asked for.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "common/lens.hpp"
#include "scene/target_folder.hpp"
#include "sim/auto_exposure.hpp"
#include "sim/sensor.hpp"
#include "sim/shutter.hpp"

namespace foresight::sim {

struct SynthOptions {
  int width = 751;         ///< px, 16 .. 8192
  int height = 570;        ///< px, 16 .. 8192
  int frames = 320;        ///< 1 .. 1,000,000
  double rate = 30;        ///< images per second, 0.1 .. 1000
  bool stereo = false;     ///< a second camera, 65 mm to the right
  bool fisheye = false;    ///< an equidistant lens of 150 degrees along the diagonal, instead of the other two
  bool distortion = true;  ///< a plumb_bob lens with strong barrel distortion; else an ideal pinhole
  unsigned seed = 1;       ///< varies wood grain, small print, noise and pose errors
  Shutter shutter = {};    ///< exposure and readout 0 .. 1 s
  Sensor sensor = {};      ///< noise 0 .. 100, exposure 0.1 .. 10, shares 0 .. 0.9; its seed is set from `seed`
  std::optional<AutoExposure> auto_exposure = {};  ///< of all cameras alike, metered by the left one
  unsigned motion = 0;                             ///< another one: the arm goes its ways in another order
  double gloss = 0;                                ///< least one of every material (Material::gloss), 0 .. 1
  bool still = false;                              ///< the arm stands; only the cameras move
  double pose_error_px = 0;  ///< root mean square displacement in the image by the errors of trajectory.txt, 0 .. 100
  double pose_error_s = 0;   ///< correlation time of these errors; 0: each image has its own; 0 .. 60
  std::optional<std::filesystem::path> head_path = {};  ///< instead of the built-in one; sim/head_path.hpp
  bool truth = true;                                    ///< write the true surface of each pixel and the true poses
};

/// Numbers about what was written.
struct SynthSummary {
  int polygons = 0;                                            ///< of the lab
  int fewest_polygons_in_view = 0, most_polygons_in_view = 0;  ///< seen at the centre of a pixel, over all images
};

inline constexpr double kNodeRate = 120;  ///< lowest rate of the poses in nodes.txt, per second

/// The left or right lens of a synthetic run.
Lens synth_lens(const SynthOptions& options, bool right);

/// Of a folder that a new synthetic run may replace.
FolderForm synth_run_form();

/// Throws InputError naming the option of `foresight synth`, the value and the range.
void check(const SynthOptions& options);

/// Writes a run as scene/run_folder.hpp reads it, and the truth as scene/ground_truth.hpp does.
/// The same options give the same bytes. Uses all cores; calls `progress(done, total)` images from
/// one thread at a time, more often than images are done, with done = 0 as long as the light is computed. An exception
/// thrown by `progress` stops the work within a tenth of a second and is passed on; only what paints the lab, the first
/// seconds, does not call it. `begins` is called once, when the lab is lit: until then a signal that ends the program
/// (end_on_stop_signals) leaves nothing on the disk either.
///
/// `out` must not exist, be an empty folder, or hold an earlier synthetic run, which is replaced.
/// All is written into a neighbour folder that takes the name `out` when it is complete; on any
/// error nothing is left. Throws InputError: an option out of range, a head path that does not do,
/// a folder of someone else, one that cannot be written. Throws RuntimeFailure: disk full.
SynthSummary write_synth_run(const std::filesystem::path& out, const SynthOptions& options,
                             const std::function<void(int, int)>& progress = {},
                             const std::function<void()>& begins = {});

}  // namespace foresight::sim
