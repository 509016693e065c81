// A recorded run as a source of frames, as late as a line with a delay would bring them.
#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "display/frame_source.hpp"
#include "display/view_session.hpp"
#include "scene/run_folder.hpp"

namespace foresight {

/// Reads the pixels of frame `index` of the run, with poses and scene. Throws InputError.
PosedFrame load_posed_frame(const RunFolder& run, std::size_t index);

/// The same, with a margin for what registration.txt expects its pose to be off; `margin_px`: that of exact poses.
PosedFrame load_posed_frame(const RunFolder& run, std::size_t index, double margin_px);

/// The model's surface, cut into charts of a size that suits the run's views.
std::shared_ptr<const SurfacePatches> surface_for(const RunFolder& run);

/// What a session needs to show the run.
ViewSetup view_setup(const RunFolder& run, const TextureOptions& textures,
                     const std::optional<thesis::Options>& thesis = std::nullopt);

/// For each image time of the run, the number of images that have arrived by then: with a delay of so many images, or
/// those not newer than the image time less `delay`.
std::vector<std::size_t> arrivals_after(const RunFolder& run, std::size_t delay_frames);
std::vector<std::size_t> arrivals_after(const RunFolder& run, Duration delay);

/// The instants are those of the run's left images.
class RecordedSource final : public FrameSource {
 public:
  /// `run` must outlive this. `arrivals`: one per image time, ascending. By the clock: every image arrives when its
  /// time has come, counted from the first advance(), whether the last one is done or not.
  RecordedSource(const RunFolder& run, std::vector<std::size_t> arrivals, double margin_px, bool by_the_clock);

  bool real_time() const override { return by_the_clock_; }
  SourceState advance() override;
  const ShownInstant& instant() const override { return instant_; }
  std::optional<PosedFrame> arrived() override;
  ViewPlace place() override;
  cv::Mat actual() override;
  std::uint64_t overtaken() const override { return overtaken_; }

  std::size_t index() const { return next_ - 1; }      ///< of the instant, in RunFolder::frames()
  std::size_t handed_out() const { return fed_ - 1; }  ///< index of the newest frame handed out

 private:
  using Clock = std::chrono::steady_clock;
  bool due(std::size_t index);

  const RunFolder& run_;
  std::vector<std::size_t> arrivals_;
  double margin_px_;
  bool by_the_clock_;
  std::optional<Clock::time_point> start_;
  ShownInstant instant_;
  std::size_t next_ = 0;  // instant
  std::size_t fed_ = 0;   // frames
  std::uint64_t overtaken_ = 0;
};

}  // namespace foresight
