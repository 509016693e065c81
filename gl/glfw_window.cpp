#include "gl/glfw_window.hpp"

#include <epoxy/gl.h>
// epoxy must come first: it replaces the system's GL header.
#include <GLFW/glfw3.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "gl/x_connection.hpp"

namespace foresight::gl {
namespace {

[[noreturn]] void fail(const std::string& what) {
  const char* text = nullptr;
  glfwGetError(&text);
  throw NoWindow(what + ": " + (text ? text : "unknown reason"), "check DISPLAY and the graphics driver");
}

std::shared_ptr<void> start_library() {
  require_address_space();
  if (!glfwInit()) fail("no desktop to open a window on");
  end_with_x_server();
  return {nullptr, [](void*) { glfwTerminate(); }};
}

GLFWwindow* create(int width, int height, const char* title, bool visible, GLFWwindow* share, Window::ContextApi api) {
  glfwDefaultWindowHints();
  // EGL on X11 too, so that contexts with and without a window come from one interface.
  const bool by_egl = api == Window::ContextApi::egl;
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, by_egl ? GLFW_EGL_CONTEXT_API : GLFW_NATIVE_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
  return glfwCreateWindow(width, height, title, nullptr, share);
}

/// px of both: how much of the one lies on the other.
std::int64_t overlap(const DesktopArea& a, const DesktopArea& b) {
  const int wide = std::min(a.x + a.width, b.x + b.width) - std::max(a.x, b.x),
            high = std::min(a.y + a.height, b.y + b.height) - std::max(a.y, b.y);
  return std::int64_t{std::max(0, wide)} * std::max(0, high);
}

std::vector<DesktopArea> desktop_screens() {
  std::vector<DesktopArea> out;
  int count = 0;
  GLFWmonitor** const monitors = glfwGetMonitors(&count);
  for (GLFWmonitor* monitor : std::span(monitors, static_cast<std::size_t>(count))) {
    DesktopArea area;
    glfwGetMonitorPos(monitor, &area.x, &area.y);
    const GLFWvidmode* const mode = glfwGetVideoMode(monitor);
    if (!mode) continue;
    area.width = mode->width;
    area.height = mode->height;
    out.push_back(area);
  }
  return out;
}

}  // namespace

int top_on_screen(const DesktopArea& window, std::span<const DesktopArea> screens) {
  std::int64_t most = 0;
  int top = 0;
  for (const DesktopArea& screen : screens)
    if (const std::int64_t of_it = overlap(window, screen); of_it > most) {
      most = of_it;
      top = screen.y;
    }
  return window.y - top;
}

Window::Window(int width, int height, const std::string& title, ContextApi api) : glfw_(start_library()), api_(api) {
  window_ = create(width, height, title.c_str(), true, nullptr, api_);
  if (!window_) fail("no window with OpenGL 4.5");
  make_current();
  glfwSwapInterval(1);
  listen();
}

// By events: a key that was released before anybody asked has been pressed all the same.
void Window::listen() {
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    auto* const self = static_cast<Window*>(glfwGetWindowUserPointer(window));
    if (action != GLFW_REPEAT) self->input_.key_events.push_back({key, action == GLFW_PRESS});
    if (action != GLFW_RELEASE) self->press(key, action);
  });
  glfwSetWindowFocusCallback(window_, [](GLFWwindow* window, int focused) {
    if (!focused) static_cast<Window*>(glfwGetWindowUserPointer(window))->input_.lost_focus = true;
  });
  glfwSetScrollCallback(window_, [](GLFWwindow* window, double, double up) {
    static_cast<Window*>(glfwGetWindowUserPointer(window))->input_.scrolled += up;
  });
  glfwSetMouseButtonCallback(window_, [](GLFWwindow* window, int button, int action, int) {
    if (button == GLFW_MOUSE_BUTTON_LEFT && action == GLFW_PRESS)
      static_cast<Window*>(glfwGetWindowUserPointer(window))->input_.pressed = true;
  });
}

void Window::press(int key, int action) {
  switch (key) {
    case GLFW_KEY_LEFT: return input_.arrows.push_back(WindowInput::Arrow::left);
    case GLFW_KEY_RIGHT: return input_.arrows.push_back(WindowInput::Arrow::right);
    case GLFW_KEY_UP: return input_.arrows.push_back(WindowInput::Arrow::up);
    case GLFW_KEY_DOWN: return input_.arrows.push_back(WindowInput::Arrow::down);
    default: break;
  }
  if (action != GLFW_PRESS) return;
  if (key == GLFW_KEY_SPACE) space_ = true;
  if (key == GLFW_KEY_ESCAPE || key == GLFW_KEY_Q) {
    input_.asked_to_end = true;
    if (close_by_keys_) close();
  }
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9) input_.keys += static_cast<char>('0' + key - GLFW_KEY_0);
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z) input_.keys += static_cast<char>('a' + key - GLFW_KEY_A);
}

WindowInput Window::take_input() {
  WindowInput out = std::exchange(input_, {});
  int width = 0, height = 0, framebuffer_width = 0, framebuffer_height = 0;
  glfwGetWindowSize(window_, &width, &height);
  framebuffer_size(framebuffer_width, framebuffer_height);
  glfwGetCursorPos(window_, &out.x, &out.y);
  out.x *= framebuffer_width / static_cast<double>(std::max(width, 1));
  out.y *= framebuffer_height / static_cast<double>(std::max(height, 1));
  out.moved_x = out.x - pointer_[0];
  out.moved_y = out.y - pointer_[1];
  pointer_ = {out.x, out.y};
  out.left = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_LEFT) == GLFW_PRESS;
  out.other = glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_RIGHT) == GLFW_PRESS ||
              glfwGetMouseButton(window_, GLFW_MOUSE_BUTTON_MIDDLE) == GLFW_PRESS;
  return out;
}

Window::Window(Window& share, int) : glfw_(share.glfw_), api_(share.api_) {
  window_ = create(16, 16, "", false, share.window_, api_);
  if (!window_) fail("no second OpenGL context");
}

Window::~Window() {
  glfwDestroyWindow(window_);
}

void Window::make_current() {
  glfwMakeContextCurrent(window_);
}
void Window::release() {
  glfwMakeContextCurrent(nullptr);
}

std::unique_ptr<Context> Window::create_shared() {
  return std::unique_ptr<Context>(new Window(*this, 0));
}

void Window::present() {
  glfwSwapBuffers(window_);
  glfwPollEvents();
}

void Window::wait_events(double timeout_s) {
  glfwWaitEventsTimeout(timeout_s);
}

bool Window::should_close() const {
  return glfwWindowShouldClose(window_);
}

void Window::close() {
  glfwSetWindowShouldClose(window_, GLFW_TRUE);
}

void Window::close_by_keys(bool may) {
  close_by_keys_ = may;
}

bool Window::take_space() {
  return std::exchange(space_, false);
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

void Window::framebuffer_size(int& width, int& height) const {
  glfwGetFramebufferSize(window_, &width, &height);
}

int Window::top_on_screen() const {
  DesktopArea area;
  glfwGetError(nullptr);  // of before
  glfwGetWindowPos(window_, &area.x, &area.y);
  if (glfwGetError(nullptr) != GLFW_NO_ERROR) return 0;
  glfwGetWindowSize(window_, &area.width, &area.height);
  int width = 0, height = 0;
  framebuffer_size(width, height);
  const double scale = height / static_cast<double>(std::max(area.height, 1));
  return static_cast<int>(std::lround(scale * gl::top_on_screen(area, desktop_screens())));
}

}  // namespace foresight::gl
