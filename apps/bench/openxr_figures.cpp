#include "apps/bench/openxr_figures.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/bench/image_feed.hpp"
#include "display/head/head_thread.hpp"
#include "display/head/runtime_offer.hpp"
#include "display/head/scene_painter.hpp"

namespace foresight {
namespace {

constexpr double kSlowestHz = 30, kMostStart = 15;  // of a headset; s until its first frame, at most
constexpr Duration kGlance = std::chrono::milliseconds(1);

nlohmann::json not_shown(const std::string& why) {
  std::printf("OpenXR session: none, %s\n", why.c_str());
  return {{"trouble", why}};
}

/// Everything that a session needs, beginning with the clock; ends in its own order.
class HeadSession {
 public:
  HeadSession(HeadLab& lab, gl::Context& context)
      : began_(clock_.now()),
        held_(std::make_shared<head::HeldControllers>()),
        drawer_(lab.session(), clock_, {.others = lab.gate()}),
        painter_(drawer_, *held_, clock_, nullptr, nullptr),
        drawing_(context.create_shared(), drawer_, clock_),
        thread_(context.create_shared(), {}, clock_, held_, painter_, [this] { painter_.release(); }),
        images_(lab) {
    context.make_current();
    painter_.show({{lab.T_world_camera(), lab.state()}, true});
  }

  double seconds() const { return to_seconds(clock_.now() - began_); }
  head::HeadStatus status() const { return thread_.status(); }
  std::uint64_t views() const { return drawer_.drawn(); }
  std::uint64_t extracted() const { return images_.extracted(); }
  /// Images come meanwhile.
  template <typename What>
  bool wait(const What& what, double until) {
    for (; !what() && seconds() < until && !status().ended; clock_.sleep_until(clock_.now() + kGlance))
      images_.feed(clock_.now());
    return what();
  }
  bool stop() { return thread_.stop(); }

 private:
  MonotonicClock clock_;
  RobotTime began_;
  std::shared_ptr<head::HeldControllers> held_;
  head::SceneDrawer drawer_;
  head::ScenePainter painter_;
  head::SceneThread drawing_;
  head::HeadThread thread_;
  ImageFeed images_;
};

}  // namespace

nlohmann::json openxr_figures(HeadLab& lab, gl::Context& context, int frames) {
  if (frames < 1) return nullptr;
  const head::RuntimeOffer offer = head::ask_runtime();
  if (!offer.there) return not_shown("there is no OpenXR runtime");
  if (!offer.opengl || !offer.egl) return not_shown("the runtime does not take OpenGL contexts made by EGL");
  HeadSession session(lab, context);
  if (!session.wait([&] { return session.status().drawn > 0; }, kMostStart)) {
    const std::string why = session.status().trouble;
    session.stop();
    return not_shown(why);
  }
  const double first = session.seconds();
  session.wait([&] { return session.views() > 0; }, kMostStart);
  const double scene = session.seconds();
  session.wait([&] { return session.status().frames >= static_cast<std::uint64_t>(frames); },
               first + 3 * frames / kSlowestHz);
  const double seconds = session.seconds();
  const head::HeadStatus status = session.status();
  const std::uint64_t views = session.views(), images = session.extracted();
  session.stop();
  std::printf(
      "OpenXR session in %s (%s): first frame after %.2f s, the scene in it after %.2f s; %llu frames in %.1f s (the "
      "headset has %.0f Hz), %llu of them without a pose, %llu jumps of time, lost %d times; views %.1f/s, images "
      "%.1f/s\n",
      status.runtime.c_str(), status.headset.c_str(), first, scene, static_cast<unsigned long long>(status.frames),
      seconds, status.rate_hz, static_cast<unsigned long long>(status.without_pose),
      static_cast<unsigned long long>(status.time_jumps), status.losses, static_cast<double>(views) / seconds,
      static_cast<double>(images) / seconds);
  return {{"runtime", status.runtime},
          {"headset", status.headset},
          {"headset_hz", status.rate_hz},
          {"start_to_first_frame_s", first},
          {"start_to_scene_s", scene},
          {"frames", status.frames},
          {"frames_with_eyes", status.drawn},
          {"frames_without_pose", status.without_pose},
          {"time_jumps", status.time_jumps},
          {"losses", status.losses},
          {"scene_hz", static_cast<double>(views) / seconds},
          {"images_hz", static_cast<double>(images) / seconds},
          {"seconds", seconds}};
}

}  // namespace foresight
