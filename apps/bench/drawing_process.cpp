#include "apps/bench/drawing_process.hpp"

#include <sys/resource.h>

#include "apps/bench/child_process.hpp"
#include "apps/bench/image_feed.hpp"
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
    : share_({most_pixels, run.scene()->nodes().size()}), pid_(start_child([&] {
        ::setpriority(PRIO_PROCESS, 0, kNice);
        draw_for(share_, run);
      })) {}

DrawingProcess::~DrawingProcess() {
  share_.end();
  wait_for_child(pid_);
}

}  // namespace foresight
