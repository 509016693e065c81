#include "gl/glfw_window.hpp"

#include <epoxy/gl.h>
// epoxy must come first: it replaces the system's GL header.
#include <GLFW/glfw3.h>

#include <utility>

#include "gl/x_connection.hpp"

namespace foresight::gl {
namespace {

[[noreturn]] void fail(const std::string& what) {
  const char* text = nullptr;
  glfwGetError(&text);
  throw NoWindow(what + ": " + (text ? text : "unknown reason"),
                 "check DISPLAY and the graphics driver, or leave out --window");
}

std::shared_ptr<void> start_library() {
  require_address_space();
  if (!glfwInit()) fail("no desktop to open a window on");
  end_with_x_server();
  return {nullptr, [](void*) { glfwTerminate(); }};
}

GLFWwindow* create(int width, int height, const char* title, bool visible, GLFWwindow* share) {
  glfwDefaultWindowHints();
  // EGL on X11 too, so that contexts with and without a window come from one interface.
  glfwWindowHint(GLFW_CONTEXT_CREATION_API, GLFW_EGL_CONTEXT_API);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
  return glfwCreateWindow(width, height, title, nullptr, share);
}

}  // namespace

Window::Window(int width, int height, const std::string& title) : glfw_(start_library()) {
  window_ = create(width, height, title.c_str(), true, nullptr);
  if (!window_) fail("no window with OpenGL 4.5");
  make_current();
  glfwSwapInterval(1);
  // By events: a key that was released before anybody asked has been pressed all the same.
  glfwSetWindowUserPointer(window_, this);
  glfwSetKeyCallback(window_, [](GLFWwindow* window, int key, int, int action, int) {
    if (action != GLFW_PRESS) return;
    if (key == GLFW_KEY_SPACE) static_cast<Window*>(glfwGetWindowUserPointer(window))->space_ = true;
    if (key == GLFW_KEY_ESCAPE || key == GLFW_KEY_Q) glfwSetWindowShouldClose(window, GLFW_TRUE);
  });
}

Window::Window(Window& share, int) : glfw_(share.glfw_) {
  window_ = create(16, 16, "", false, share.window_);
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

bool Window::take_space() {
  return std::exchange(space_, false);
}

void Window::set_title(const std::string& title) {
  glfwSetWindowTitle(window_, title.c_str());
}

void Window::framebuffer_size(int& width, int& height) const {
  glfwGetFramebufferSize(window_, &width, &height);
}

}  // namespace foresight::gl
