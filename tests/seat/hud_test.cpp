// The head-up display, drawn without a window.
#include "seat/hud.hpp"
#include "gl/context.hpp"

namespace foresight::hud_test {
namespace {

cv::Mat drawn(const HudContent& content, int width, int height) {
  gl::Texture texture(GL_RGBA8, width, height, 0, 1, "hud");
  const TextureTarget target(texture.name(), width, height);
  fill(target.whole(), 0.2f, 0.2f, 0.2f);
  Hud hud;
  hud.draw(content, target.whole());
  cv::Mat out(height, width, CV_8UC4);
  glGetTextureImage(texture.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
  return out;
}

double changed(const cv::Mat& picture) {
  cv::Mat grey;
  cv::inRange(picture, cv::Scalar(50, 50, 50, 0), cv::Scalar(52, 52, 52, 255), grey);
  return 1 - cv::countNonZero(grey) / static_cast<double>(picture.total());
}

TEST(Hud, SaysWhatItIsToldAndLeavesTheRestAlone) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = "a robot";
  content.lines = {{"robot", "follows", "", Urgency::fine}, {"line", "gone", "wait", Urgency::trouble}};
  const cv::Mat few = drawn(content, 640, 480);
  EXPECT_GT(changed(few), 0.01);
  EXPECT_LT(changed(few), 0.3) << "the picture behind is what counts";
  content.next = {"next", "press again", "let go first", Urgency::trouble};
  content.keys = {{"space", "stop"}};
  EXPECT_GT(changed(drawn(content, 640, 480)), changed(few));
}

TEST(Hud, BearsAnyWindow) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = std::string(3000, 'x');
  content.lines.assign(200, {"robot", std::string(500, 'w'), "", Urgency::note});
  for (const auto& [width, height] : {std::pair{1, 1}, {3, 500}, {640, 2}}) drawn(content, width, height);
  EXPECT_EQ(glGetError(), static_cast<GLenum>(GL_NO_ERROR));
}

}  // namespace
}  // namespace foresight::hud_test
