#include "rig_view/rig_window.hpp"

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "display/uploaded_picture.hpp"
#include "display/view_window.hpp"
#include "gl/glfw_window.hpp"
#include "rig_view/rig_picture.hpp"

namespace foresight {
namespace {

using gl::WindowInput;

constexpr double kLook = 0.03;   // s, for events
constexpr double kArrow = 0.01;  // of a joint's range, for a key

std::unique_ptr<gl::Window> open_window(const RigWindowOptions& options) {
  try {
    auto window = std::make_unique<gl::Window>(options.width, options.height, options.title);
    gl::set_up_context();
    return window;
  } catch (const gl::NoWindow& error) {
    throw RuntimeFailure(std::string("the rig's window: ") + error.what(),
                         "or write a picture: `foresight rig view --out`");
  }
}

}  // namespace

struct RigWindow::Work {
  RigBody& body;
  RigWindowOptions options;
  std::unique_ptr<gl::Window> window;
  RigPicture picture;
  UploadedPicture uploaded{"rig view"};
  PictureCopy copy;
  PanelState state;
  Eye eye;
  int width = 0, height = 0;
  std::optional<std::size_t> pulled;  // joint whose slider the mouse holds
  bool orbits = false;

  Work(RigBody& of, RigWindowOptions given)
      : body(of), options(std::move(given)), window(open_window(options)), picture(body) {
    window->framebuffer_size(width, height);
    state.title = body.rig().name;
    state.positions = options.positions;
    state.about_cameras = body.about_cameras();
    state.selected = body.rig().joints.empty() || options.live ? -1 : 0;
    state.help = {"mouse: left turns, right shifts, wheel zooms",
                  "views: f front, s side, t top, i iso; p perspective"};
    if (!options.live) state.help.emplace_back("sliders, or arrows: joint, position; r: all at rest");
    state.help.emplace_back("1-8 or a click on the legend: show, hide");
    state.help.emplace_back("q ends");
    look_from(LookFrom::iso);
  }

  void look_from(LookFrom side) {
    eye = Eye::from(side, body.extent(), (width - kPanelWidth) / static_cast<double>(std::max(height, 1)));
  }

  const DriveConfig& drive(std::size_t joint) const { return body.rig().joints[joint].drive; }

  /// True: there is something new to draw.
  bool take_live() {
    const auto now = options.live ? options.live() : std::nullopt;
    if (!now) return false;
    for (std::size_t i = 0; i < std::min(now->positions.size(), state.positions.size()); ++i)
      if (std::isfinite(now->positions[i])) state.positions[i] = now->positions[i];
    state.live = now->state;
    state.live_is_bad = now->is_bad;
    return true;
  }

  void toggle(std::size_t layer) { state.layers[layer] = !state.layers[layer]; }

  bool take_key(char key) {
    switch (key) {
      case 'f': look_from(LookFrom::front); return true;
      case 's': look_from(LookFrom::side); return true;
      case 't': look_from(LookFrom::top); return true;
      case 'i': look_from(LookFrom::iso); return true;
      case 'p': eye.perspective = !eye.perspective; return true;
      case 'r':
        if (!options.live) state.positions = body.rest();
        return true;
      default: break;
    }
    if (key < '1' || key >= '1' + static_cast<int>(kLayers)) return false;
    toggle(static_cast<std::size_t>(key - '1'));
    return true;
  }

  void take_arrow(WindowInput::Arrow arrow) {
    if (state.selected < 0) return;
    const int count = static_cast<int>(state.positions.size());
    const auto joint = static_cast<std::size_t>(state.selected);
    const double step = kArrow * (drive(joint).max_position - drive(joint).min_position);
    const auto move = [&](double by) {
      state.positions[joint] =
          std::clamp(state.positions[joint] + by, drive(joint).min_position, drive(joint).max_position);
    };
    switch (arrow) {
      case WindowInput::Arrow::up: state.selected = (state.selected + count - 1) % count; break;
      case WindowInput::Arrow::down: state.selected = (state.selected + 1) % count; break;
      case WindowInput::Arrow::left: move(-step); break;
      case WindowInput::Arrow::right: move(step); break;
    }
  }

  void press(cv::Point at) {
    const PanelLayout layout(state.positions.size(), height);
    pulled.reset();
    orbits = at.x < 0;
    if (orbits) return;
    if (const auto layer = layout.layer_at(at)) return toggle(*layer);
    if (options.live) return;
    pulled = layout.joint_at(at);
    if (pulled) state.selected = static_cast<int>(*pulled);
  }

  bool take_mouse(const WindowInput& input) {
    const cv::Point in_panel(cvRound(input.x) - (width - kPanelWidth), cvRound(input.y));
    if (input.pressed) press(in_panel);
    if (!input.left) {
      pulled.reset();
      orbits = false;
    }
    const bool moved = input.moved_x != 0 || input.moved_y != 0;
    if (pulled)
      state.positions[*pulled] =
          PanelLayout(state.positions.size(), height).position_at(drive(*pulled), *pulled, in_panel.x);
    if (orbits && moved) eye.orbit(input.moved_x, input.moved_y);
    if (input.other && moved) eye.shift(input.moved_x, input.moved_y, height);
    if (input.scrolled != 0) eye.zoom(input.scrolled);
    return input.pressed || pulled || ((orbits || input.other) && moved) || input.scrolled != 0;
  }

  bool take_input() {
    const WindowInput input = window->take_input();
    bool changed = take_mouse(input);
    for (const char key : input.keys) changed |= take_key(key);
    for (const WindowInput::Arrow arrow : input.arrows) take_arrow(arrow);
    const int old_width = width, old_height = height;
    window->framebuffer_size(width, height);
    return changed || !input.arrows.empty() || width != old_width || height != old_height;
  }

  void draw() {
    if (width <= kPanelWidth + 16 || height < 16) return;
    uploaded.upload(picture(body, body.at(state.positions), state, eye, width, height));
    copy(uploaded.texture(), window_target(*window));
  }
};

RigWindow::RigWindow(RigBody& body, RigWindowOptions options)
    : work_(std::make_unique<Work>(body, std::move(options))) {}

RigWindow::~RigWindow() = default;

void RigWindow::run(const std::function<bool()>& stopped) {
  Work& work = *work_;
  for (bool changed = true; !stopped() && !work.window->should_close();) {
    changed |= work.take_live();
    if (changed) {
      work.draw();
      work.window->present();
    }
    work.window->wait_events(kLook);
    changed = work.take_input();
  }
}

}  // namespace foresight
