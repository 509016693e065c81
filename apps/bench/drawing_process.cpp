#include "apps/bench/drawing_process.hpp"

#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "apps/bench/image_feed.hpp"
#include "common/error.hpp"
#include "display/head/scene_drawer.hpp"

namespace foresight {
namespace {

constexpr Duration kBetweenLooks = std::chrono::milliseconds(1);
constexpr int kNice = 10;  // frames go before views where both share processors

/// Until the other side ends it.
void draw_for(head::ViewShare& share, const RunFolder& run) {
  MonotonicClock clock;
  const auto wait = [&] { clock.sleep_until(clock.now() + kBetweenLooks); };
  std::optional<head::HeadAim> aim;
  while (!share.ended() && !(aim = share.take_aim())) wait();
  if (share.ended()) return;
  const auto context = gl::create_headless_context();
  gl::set_up_context();
  HeadLab lab(run, *context, clock);
  ImageFeed images(lab);
  head::SceneDrawer drawer(lab.session(), clock, {.in_bands = false});
  for (; !share.ended(); aim = share.take_aim()) {
    images.feed(clock.now());
    if (aim) drawer.aim(*std::exchange(aim, std::nullopt));
    if (drawer.draw())
      share.put(*drawer.newest());
    else
      wait();
  }
  drawer.release();
}

}  // namespace

DrawingProcess::DrawingProcess(const RunFolder& run, std::size_t most_pixels)
    : share_({most_pixels, run.scene()->nodes().size()}) {
  std::fflush(nullptr);
  pid_ = ::fork();
  if (pid_ < 0) throw RuntimeFailure("no process can be made", "end other programs");
  if (pid_ > 0) return;
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  ::setpriority(PRIO_PROCESS, 0, kNice);
  try {
    draw_for(share_, run);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench: the drawing process has ended: %s\n", error.what());
  }
  std::fflush(nullptr);
  ::_exit(0);
}

DrawingProcess::~DrawingProcess() {
  share_.end();
  ::waitpid(pid_, nullptr, 0);
}

}  // namespace foresight
