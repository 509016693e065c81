#include "display/recorded_source.hpp"

#include <algorithm>
#include <thread>

namespace foresight {
namespace {

constexpr std::chrono::milliseconds kNap(50);  // whoever asks wants to look at other things in between

/// A few views spread over the run.
std::vector<ExpectedView> some_views(const RunFolder& run) {
  constexpr std::size_t kMost = 12;
  const auto& frames = run.frames();
  std::vector<ExpectedView> views;
  for (std::size_t i = 0; i < frames.size(); i += std::max<std::size_t>(1, frames.size() / kMost))
    views.push_back({frames[i].left.T_world_camera, run.state_at(frames[i].left.time)});
  return views;
}

}  // namespace

PosedFrame load_posed_frame(const RunFolder& run, std::size_t index) {
  const auto posed = [&](const RunImage& image, const Lens& lens) {
    return PosedImage{read_run_image(image, lens), image.time, image.T_world_camera, run.state_at(image.time)};
  };
  const RunFrame& frame = run.frames()[index];
  PosedFrame out{posed(frame.left, run.lens_left()), std::nullopt};
  if (frame.right) out.right = posed(*frame.right, *run.lens_right());
  return out;
}

PosedFrame load_posed_frame(const RunFolder& run, std::size_t index, double margin_px) {
  PosedFrame frame = load_posed_frame(run, index);
  if (const auto px = run.frames()[index].left.predicted_px) {
    frame.left.margin_px = margin_for(margin_px, *px);
    if (frame.right) frame.right->margin_px = frame.left.margin_px;
  }
  return frame;
}

std::shared_ptr<const SurfacePatches> surface_for(const RunFolder& run) {
  return surface_for(*run.scene(), run.lens_left(), some_views(run));
}

ViewSetup view_setup(const RunFolder& run, const TextureOptions& textures,
                     const std::optional<thesis::Options>& thesis) {
  return {run.scene(), thesis ? nullptr : surface_for(run), run.lens_left(), run.lens_right(), textures, thesis};
}

std::vector<std::size_t> arrivals_after(const RunFolder& run, std::size_t delay_frames) {
  std::vector<std::size_t> arrived(run.frames().size());
  for (std::size_t i = 0; i < arrived.size(); ++i) arrived[i] = i + 1 > delay_frames ? i + 1 - delay_frames : 0;
  return arrived;
}

std::vector<std::size_t> arrivals_after(const RunFolder& run, Duration delay) {
  const auto& frames = run.frames();
  std::vector<std::size_t> arrived(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    arrived[i] = i ? arrived[i - 1] : 0;
    while (arrived[i] < frames.size() && frames[arrived[i]].left.time <= frames[i].left.time - delay) ++arrived[i];
  }
  return arrived;
}

RecordedSource::RecordedSource(const RunFolder& run, std::vector<std::size_t> arrivals, double margin_px,
                               bool by_the_clock)
    : run_(run), arrivals_(std::move(arrivals)), margin_px_(margin_px), by_the_clock_(by_the_clock) {}

/// Whether the time of image `index` has come; waits for it, a nap at most.
bool RecordedSource::due(std::size_t index) {
  const auto& frames = run_.frames();
  if (!start_) start_ = Clock::now();
  const auto time =
      *start_ + std::chrono::duration_cast<Clock::duration>(frames[index].left.time - frames.front().left.time);
  std::this_thread::sleep_until(std::min(time, Clock::now() + kNap));
  return Clock::now() >= time;
}

SourceState RecordedSource::advance() {
  const auto& frames = run_.frames();
  if (next_ == frames.size()) return SourceState::ended;
  if (by_the_clock_ && !due(next_)) return SourceState::waiting;
  const RunImage& image = frames[next_].left;
  instant_ = {image.stem, image.time, false, arrivals_[next_] == 0};
  ++next_;
  if (by_the_clock_ && next_ < frames.size()) {
    const auto after = frames[next_].left.time - frames.front().left.time;
    instant_.late = Clock::now() > *start_ + std::chrono::duration_cast<Clock::duration>(after);
  }
  return SourceState::ready;
}

std::optional<PosedFrame> RecordedSource::arrived() {
  const std::size_t there = arrivals_[index()];
  if (fed_ >= there) return std::nullopt;
  if (by_the_clock_) {  // those that came meanwhile are never even decoded
    overtaken_ += there - fed_ - 1;
    fed_ = there - 1;
  }
  return load_posed_frame(run_, fed_++, margin_px_);
}

ViewPlace RecordedSource::place() {
  const RunImage& image = run_.frames()[index()].left;
  return {image.T_world_camera, run_.state_at(image.time)};
}

cv::Mat RecordedSource::actual() {
  return read_run_image(run_.frames()[index()].left, run_.lens_left());
}

}  // namespace foresight
