// A window on the desktop, with the context that draws into it.
#pragma once

#include <memory>
#include <string>

#include "common/error.hpp"
#include "gl/context.hpp"

struct GLFWwindow;

namespace foresight::gl {

/// No desktop, or no OpenGL 4.5 on it.
class NoWindow : public RuntimeFailure {
 public:
  using RuntimeFailure::RuntimeFailure;
};

/// A GLFW window. All methods on the main thread (a rule of GLFW); only make_current() of shared
/// contexts may be called elsewhere.
class Window final : public Context {
 public:
  /// Opens a window of `width` x `height` screen units, shown at once, its context current.
  /// Throws NoWindow with GLFW's own description.
  Window(int width, int height, const std::string& title);
  ~Window() override;
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void make_current() override;
  void release() override;
  std::unique_ptr<Context> create_shared() override;  ///< as a hidden window

  /// Shows what was drawn and handles events, without blocking longer than one display frame.
  void present();
  void wait_events(double timeout_s);  ///< handles events, or returns after the time-out
  bool should_close() const;           ///< closed by the user, or Escape or Q pressed
  bool take_space();                   ///< the space bar was pressed since the last call
  void set_title(const std::string& title);
  void framebuffer_size(int& width, int& height) const;  ///< px

 private:
  Window(Window& share, int);
  std::shared_ptr<void> glfw_;  // glfwTerminate with the last window
  GLFWwindow* window_ = nullptr;
  bool space_ = false;
};

}  // namespace foresight::gl
