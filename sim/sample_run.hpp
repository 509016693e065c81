// Writes the built-in sample run: a recorded run of a small lab, rendered here, so that a fresh
// machine has an input whose poses, model and lens are exactly true.
#pragma once

#include <filesystem>
#include <functional>

#include "common/lens.hpp"

namespace foresight::sim {

struct SampleRunOptions {
  int width = 640;         ///< px, 16 .. 8192
  int height = 480;        ///< px, 16 .. 8192
  int frames = 90;         ///< 1 .. 1,000,000, at 30 per second
  bool stereo = false;     ///< a second camera, 65 mm to the right
  bool fisheye = false;    ///< an equidistant lens of 150 degrees along the diagonal, instead of the other two
  bool distortion = true;  ///< a plumb_bob lens with strong barrel distortion; else an ideal pinhole
  unsigned seed = 1;       ///< varies wood grain and small print
};

inline constexpr double kSampleFrameRate = 30;  ///< images per second
inline constexpr int kSamplePosesPerFrame = 4;  ///< plate poses in nodes.txt per image: 120 Hz

/// The left or right lens of the sample run.
Lens sample_lens(const SampleRunOptions& options, bool right);

/// Writes camera.yaml, rgb.txt, trajectory.txt, nodes.txt, scene.yaml with PLY meshes, the images,
/// and for stereo camera_right.yaml and rgb_right.txt. The same options give the same bytes. Uses
/// all cores; calls `progress(done, total)` images from one thread at a time, with done = 0 as long as
/// the light is computed. An exception thrown by `progress` stops the work and is passed on.
///
/// `out` must not exist, be an empty folder, or hold an earlier sample run, which is replaced.
/// All is written into a neighbour folder that takes the name `out` when it is complete; on any
/// error nothing is left. Throws InputError: an option out of range, a folder of someone else, one
/// that cannot be written. Throws RuntimeFailure: disk full.
void write_sample_run(const std::filesystem::path& out, const SampleRunOptions& options,
                      const std::function<void(int, int)>& progress = {});

}  // namespace foresight::sim
