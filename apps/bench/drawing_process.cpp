#include "apps/bench/drawing_process.hpp"

#include <sys/resource.h>

#include "apps/bench/child_process.hpp"
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
  share.tell("waits to be told where the eyes are");
  while (!share.ended() && !(aim = share.take_aim())) wait();
  if (share.ended()) return;
  share.tell("makes an OpenGL context");
  const auto context = gl::create_headless_context();
  gl::set_up_context();
  share.tell("makes textures of the first images");
  HeadLab lab(run, *context, clock);
  ImageFeed images(lab);
  head::SceneDrawer drawer(lab.session(), clock, {.in_bands = false});
  for (; !share.ended(); aim = share.take_aim()) {
    share.tell("takes in an image");
    images.feed(clock.now());
    share.tell("draws");
    if (aim) drawer.aim(*std::exchange(aim, std::nullopt));
    const bool drew = drawer.draw();
    share.tell(drew ? "hands over what it drew"
                    : "has nothing to draw: nobody says where the eyes are, or there are no textures");
    if (!drew)
      wait();
    else if (!share.put(*drawer.newest()))
      throw RuntimeFailure("a view is larger than what both processes share", "ask for smaller ones");
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
  if (!end_) wait_for_child(pid_);
}

std::string DrawingProcess::failure() {
  if (!end_) end_ = end_of_child(pid_);
  return end_ ? "the process that draws " + *end_ + " (last, it " + share_.doing() + ")" : "";
}

std::string DrawingProcess::doing() const {
  return std::string("the process that draws ") + share_.doing();
}

}  // namespace foresight
