#include "apps/bench/display_trial.hpp"

#include <algorithm>
#include <random>

#include "apps/bench/taken_cores.hpp"
#include "common/clock.hpp"
#include "common/statistics.hpp"
#include "display/frame_pacer.hpp"
#include "display/rehearsal.hpp"
#include "seat/seat_textures.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr int kInputs = 8;          // instants of an input that are looked at, per frame
constexpr double kLate = 3;         // intervals
constexpr double kMostRounds = 10;  // lengths of a round that the first image is waited for
constexpr Duration kLongestWait = 1s;
constexpr const char* kRenderer = "llvmpipe";  // what its threads are called

struct Shown {
  RobotTime look, swapped;
  double taken_s = 0;
};

double ms(Duration d) {
  return 1e3 * to_seconds(d);
}

/// As the seat did before frames were paced: the next one an interval after this one began.
class EachInterval {
 public:
  EachInterval(Clock& clock, double rate_hz) : clock_(clock), interval_(seconds(1 / rate_hz)), due_(clock.now()) {}
  bool wait(Duration /*most*/) {
    clock_.sleep_until(due_);
    due_ = std::max(due_ + interval_, clock_.now());
    return true;
  }
  void drawn() { glFinish(); }
  void swapped() {}
  PacingFigures figures() const { return {}; }

 private:
  Clock& clock_;
  Duration interval_;
  RobotTime due_;
};

template <typename Pacer>
std::vector<Shown> show(const DrawFrame& draw, const DisplayRound& round, const BusyTextures& textures, Clock& clock,
                        Pacer pacer) {
  std::vector<Shown> out;
  TakenCores taken(kRenderer);
  const RobotTime start = clock.now();
  const std::uint64_t finished = textures.finished();
  const auto ends = [&] {
    const bool has_images = !textures.runs() || textures.finished() > finished;
    return clock.now() >= start + seconds((has_images ? 1 : kMostRounds) * round.seconds);
  };
  while (!ends()) {
    while (!pacer.wait(kLongestWait)) {
    }
    Shown frame;
    frame.look = clock.now();
    const TextureLease lease = textures.textures().acquire();
    const ImagesLease images = textures.images().acquire();
    draw(round.place, lease, images, ms(pacer.figures().last));
    pacer.drawn();
    frame.swapped = clock.now();
    pacer.swapped();
    frame.taken_s = taken.since_last();
    out.push_back(frame);
  }
  return out;
}

DisplayFigures figures_of(const std::vector<Shown>& shown, double rate_hz) {
  std::vector<double> intervals, drawings, inputs, beyond;
  const double interval = 1e3 / rate_hz;
  double late = 0, late_own = 0;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> share(0, 1);
  for (std::size_t i = 1; i < shown.size(); ++i) {
    intervals.push_back(ms(shown[i].swapped - shown[i - 1].swapped));
    drawings.push_back(ms(shown[i].swapped - shown[i].look));
    late += intervals.back() > kLate * interval;
    late_own += intervals.back() - 1e3 * shown[i].taken_s > kLate * interval;
    for (int k = 0; k < kInputs; ++k) {
      const double before_look = share(random) * ms(shown[i].look - shown[i - 1].look);
      inputs.push_back(before_look + drawings.back());
      beyond.push_back(before_look);
    }
  }
  const double count = std::max<double>(1, static_cast<double>(intervals.size()));
  return {.frames = shown.size(),
          .interval_p50 = quantile(intervals, 0.5),
          .interval_p99 = quantile(intervals, 0.99),
          .drawing_p50 = quantile(drawings, 0.5),
          .drawing_p99 = quantile(drawings, 0.99),
          .input_to_swap_p99 = quantile(inputs, 0.99),
          .input_beyond_drawing_p99 = quantile(beyond, 0.99),
          .late_share = late / count,
          .late_share_own = late_own / count};
}

}  // namespace

BusyTextures::BusyTextures(gl::Context& context, const DisplayScene& scene, std::shared_ptr<FrameGate> gate)
    : thread_(context.create_shared(),
              {scene.model, scene.surface, scene.camera, std::nullopt, kSeatTextures, true, std::move(gate), true}) {
  context.make_current();
  for (PosedFrame& frame : rehearsal_frames(*scene.model, scene.camera, std::nullopt))
    thread_.process(std::move(frame));
  thread_.begin_anew();
  feeder_ = std::jthread([this](const std::stop_token& stop) {
    try {
      feed(stop);
    } catch (...) {
      error_ = std::current_exception();
      failed_ = true;
    }
  });
}

void BusyTextures::feed(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    busy_ = works_.load();
    if (busy_) {
      thread_.process(next());
      ++finished_;
    } else {
      std::this_thread::sleep_for(1ms);
    }
  }
}

void BusyTextures::check() const {
  if (failed_) std::rethrow_exception(error_);
}

BusyTextures::~BusyTextures() = default;

PosedFrame BusyTextures::next() {
  return (*images_)[next_++ % images_->size()];
}

void BusyTextures::take(const std::vector<PosedFrame>& images) {
  images_ = &images;
  next_ = 0;
  finish(images.size());
}

void BusyTextures::finish(std::size_t images) {
  const std::uint64_t until = finished_ + images;
  works_ = true;
  while (finished_ < until && !failed_) std::this_thread::sleep_for(1ms);
  works_ = false;
  while (busy_ && !failed_) std::this_thread::sleep_for(1ms);
  check();
}

DisplayFigures show_frames(const DrawFrame& draw, const DisplayRound& round, BusyTextures& textures,
                           const std::shared_ptr<FrameGate>& gate) {
  MonotonicClock clock;
  const std::uint64_t before = textures.finished();
  const RobotTime start = clock.now();
  FramePacingOptions pacing;
  pacing.rate_hz = round.rate_hz;
  const auto shown = round.paced ? show(draw, round, textures, clock, FramePacer(clock, pacing, gate))
                                 : show(draw, round, textures, clock, EachInterval(clock, round.rate_hz));
  textures.check();
  DisplayFigures out = figures_of(shown, round.rate_hz);
  out.images_per_s = static_cast<double>(textures.finished() - before) / to_seconds(clock.now() - start);
  return out;
}

}  // namespace foresight
