// Where a window is on its screen.
#include "gl/glfw_window.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <gtest/gtest.h>

#include <optional>

namespace foresight::gl::glfw_window_test {
namespace {

TEST(GlfwWindow, RowsAreThoseOfTheScreenThatHasMostOfIt) {
  const DesktopArea screens[] = {{0, 0, 1920, 1080}, {1920, 37, 1280, 1024}};
  EXPECT_EQ(top_on_screen({100, 51, 800, 600}, screens), 51);
  EXPECT_EQ(top_on_screen({2000, 51, 800, 600}, screens), 14);
  EXPECT_EQ(top_on_screen({1900, 51, 800, 600}, screens), 14) << "on both";
  EXPECT_EQ(top_on_screen({1200, 51, 800, 600}, screens), 51) << "on both";
  EXPECT_EQ(top_on_screen({100, -9, 800, 600}, screens), -9) << "cut by the screen's top";
  EXPECT_EQ(top_on_screen({100, 9, 800, 600}, {}), 9);
}

TEST(GlfwWindow, TellsWhereItIs) {
  std::optional<Window> window;
  try {
    window.emplace(320, 240, "place");
  } catch (const NoWindow& e) {
    GTEST_SKIP() << e.what();
  }
  const int platform_tells = [] {
    int x = -1, y = -1;
    glfwGetError(nullptr);
    glfwGetWindowPos(glfwGetCurrentContext(), &x, &y);
    return glfwGetError(nullptr);
  }();
  if (platform_tells != GLFW_NO_ERROR) GTEST_SKIP() << "this desktop tells no places";
  for (const int y : {40, 41, 75}) {
    glfwSetWindowPos(glfwGetCurrentContext(), 30, y);
    for (int i = 0; i < 50 && window->top_on_screen() != y; ++i) window->wait_events(0.02);
    EXPECT_EQ(window->top_on_screen(), y);
  }
}

}  // namespace
}  // namespace foresight::gl::glfw_window_test
