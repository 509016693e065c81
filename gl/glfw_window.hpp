// A window on the desktop, with the context that draws into it.
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "common/error.hpp"
#include "gl/context.hpp"

struct GLFWwindow;

namespace foresight::gl {

/// No desktop, or no OpenGL 4.5 on it.
class NoWindow : public RuntimeFailure {
 public:
  using RuntimeFailure::RuntimeFailure;
};

/// What mouse and keys did.
struct WindowInput {
  enum class Arrow { left, right, up, down };
  double x = 0, y = 0;               ///< the pointer now, px of the framebuffer, y downwards
  double moved_x = 0, moved_y = 0;   ///< since the last call
  bool left = false, other = false;  ///< held: the left button; the right or middle one
  bool pressed = false;              ///< the left button went down since the last call
  double scrolled = 0;               ///< steps, upwards
  std::string keys;                  ///< letters, in lower case, and digits that were pressed
  std::vector<Arrow> arrows;         ///< pressed or held long enough to repeat
  struct Key {
    int code = 0;  ///< GLFW's: the key's place on the keyboard, whatever is printed there
    bool down = false;
  };
  std::vector<Key> key_events;  ///< each press and release, oldest first
  bool asked_to_end = false;    ///< Escape or Q was pressed
  bool lost_focus = false;      ///< somebody else had the keyboard, if only for a moment: releases may have been missed
};

/// Of a window's content, or of a screen, on the desktop.
struct DesktopArea {
  int x = 0, y = 0, width = 0, height = 0;  ///< screen units, y downwards
};
/// Rows of the desktop from the top of the screen that has most of the window to the window's own; from the desktop's
/// where no screen has any of it.
int top_on_screen(const DesktopArea& window, std::span<const DesktopArea> screens);

/// A GLFW window. All methods on the main thread (a rule of GLFW); only make_current() of shared
/// contexts may be called elsewhere.
class Window final : public Context {
 public:
  /// How contexts are made: by EGL, as those without a window are, or by the desktop's own way (GLX), which some
  /// runtimes of head displays want.
  enum class ContextApi { egl, native };

  /// Opens a window of `width` x `height` screen units, shown at once, its context current.
  /// Throws NoWindow with GLFW's own description.
  Window(int width, int height, const std::string& title, ContextApi api = ContextApi::egl);
  ~Window() override;
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  void make_current() override;
  void release() override;
  std::unique_ptr<Context> create_shared() override;  ///< as a hidden window

  /// Shows what was drawn and handles events, without blocking longer than one display frame.
  void present();
  void wait_events(double timeout_s);  ///< handles events, or returns after the time-out
  bool should_close() const;           ///< closed by the user or close(), or Escape or Q pressed
  void close();                        ///< from now on should_close()
  void close_by_keys(bool may);        ///< false: WindowInput alone says that Escape or Q was pressed
  bool take_space();                   ///< the space bar was pressed since the last call
  WindowInput take_input();            ///< since the last call
  void set_title(const std::string& title);
  void framebuffer_size(int& width, int& height) const;  ///< px
  /// The row of its screen that its first row is, px. 0 where the desktop tells nobody where windows are (Wayland).
  int top_on_screen() const;

 private:
  Window(Window& share, int);
  void listen();
  void press(int key, int action);
  std::shared_ptr<void> glfw_;  // glfwTerminate with the last window
  ContextApi api_;
  GLFWwindow* window_ = nullptr;
  bool space_ = false, close_by_keys_ = true;
  WindowInput input_;
  std::array<double, 2> pointer_{};  // at the last take_input()
};

}  // namespace foresight::gl
