// The head-up display, drawn without a window.
#include "seat/hud.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <tuple>

#include "gl/context.hpp"
#include "seat/seat_keys.hpp"

namespace foresight::hud_test {
namespace {

cv::Mat drawn(const HudContent& content, int width, int height, double scale = 1, std::size_t* next_key = nullptr) {
  gl::Texture texture(GL_RGBA8, width, height, 0, 1, "hud");
  const TextureTarget target(texture.name(), width, height);
  fill(target.whole(), 0.2f, 0.2f, 0.2f);
  Hud hud(scale);
  hud.draw(content, target.whole());
  if (next_key) *next_key = hud.next_key();
  cv::Mat out(height, width, CV_8UC4);
  glGetTextureImage(texture.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
  return out;
}

void keep(const std::string& name, const cv::Mat& picture) {
  const char* const folder = std::getenv("FORESIGHT_PICTURES");
  if (!folder) return;
  cv::Mat top_first;
  cv::flip(picture, top_first, 0);
  cv::imwrite(std::string(folder) + "/" + name + ".png", top_first);
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

TEST(Hud, StaysWithinItsPartOfAWindow) {
  const auto context = gl::create_headless_context();
  gl::Texture texture(GL_RGBA8, 640, 480, 0, 1, "hud");
  const TextureTarget whole(texture.name(), 640, 480);
  fill(whole.whole(), 0.2f, 0.2f, 0.2f);
  ViewTarget part = whole.whole();
  part.x = 320, part.y = 40, part.width = 320, part.height = 440;
  HudContent content;
  content.title = "a robot";
  content.keys = {{"space", "stop"}};
  Hud().draw(content, part);
  cv::Mat out(480, 640, CV_8UC4);
  glGetTextureImage(texture.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
  EXPECT_EQ(changed(out.colRange(0, 320)), 0);
  EXPECT_EQ(changed(out.rowRange(0, 40)), 0);
  EXPECT_GT(changed(out.rowRange(40, 120)), 0.005) << "the keys, at its lower end";
  EXPECT_GT(changed(out.rowRange(400, 480)), 0.005) << "the title, at its upper end";
}

// As before an eye of a head display, where there is little room.
TEST(Hud, LongWordsStayWithinTheirArea) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = "a robot";
  content.next = {"next", "joints look for home, one after the other, slowly, waiting for shoulder_pitch",
                  "wait; space stops them", Urgency::note};
  content.area = HudArea{60, 20, 300, 360};
  const cv::Mat picture = drawn(content, 480, 400);
  EXPECT_EQ(changed(picture.colRange(0, 60)), 0);
  EXPECT_EQ(changed(picture.colRange(360, 480)), 0);
  EXPECT_EQ(changed(picture.rowRange(0, 20)), 0);
  EXPECT_EQ(changed(picture.rowRange(380, 400)), 0);
  EXPECT_GT(changed(picture(cv::Rect(60, 20, 300, 80))), 0.3) << "in more than one row";
  const cv::Mat without_keys = picture(cv::Rect(60, 20, 300, 90)).clone();
  content.keys = {{"space", "stop"}};
  const cv::Mat with_keys = drawn(content, 480, 400);
  EXPECT_EQ(cv::norm(without_keys, with_keys(cv::Rect(60, 20, 300, 90)), cv::NORM_L1), 0)
      << "keys make way for what is next";
}

TEST(Hud, ANarrowWindowBreaksNoWord) {
  const auto context = gl::create_headless_context();
  const auto rows = [](const std::string& word) {
    HudContent content;
    content.title = "a robot";
    content.lines = {{"robot", word, "", Urgency::trouble}};
    const cv::Mat picture = drawn(content, 320, 240);
    keep("narrow_" + word, picture);
    int out = 0;
    for (int y = 0; y < picture.rows; ++y) out += changed(picture.row(y)) > 0;
    return out;
  };
  EXPECT_EQ(rows("shoulder_pitch_joint"), rows("elbow"));
}

TEST(Hud, InASmallWindowKeysMakeWayForWhatIsSaid) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = "a robot";
  content.lines.assign(8, {"robot", "follows", "", Urgency::fine});
  const cv::Mat without = drawn(content, 700, 420);
  content.keys.assign(20, {"key", "does something"});
  const cv::Mat with = drawn(content, 700, 420);
  const cv::Rect lines(0, 200, 700, 220);  // the first row is the lowest
  EXPECT_EQ(cv::norm(without(lines), with(lines), cv::NORM_L1), 0);
  EXPECT_EQ(changed(without.rowRange(0, 160)), 0);
  EXPECT_GT(changed(with.rowRange(0, 160)), 0.02) << "as many of them as fit";
}

// Where one panel is over another, it is darker than one panel over the picture.
TEST(Hud, NoPanelIsOverAnotherInASmallWindow) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = "a robot with a name: the newest image, as prediction cannot be trusted (at 78 % of its size)";
  content.next = {"next", "joints look for home, one after the other, slowly", "wait; space stops them", Urgency::note};
  content.lines.assign(
      15, {"in command", "you; the robot follows, and says so in some more words than one row has room for", "wait"});
  content.lines.push_back({"headset", "it is gone", "", Urgency::trouble});
  content.keys.assign(22, {"W S A D R F", "the tool: forward, left, back, right, up, down"});
  for (const auto& [width, height] : {std::pair{640, 480}, {700, 500}, {800, 600}, {900, 650}, {1280, 800}}) {
    const cv::Mat picture = drawn(content, width, height);
    cv::Mat dark, alarm;
    cv::inRange(picture, cv::Scalar(0, 0, 0, 0), cv::Scalar(26, 26, 26, 255), dark);
    EXPECT_EQ(cv::countNonZero(dark), 0) << width << " x " << height;
    cv::inRange(picture, cv::Scalar(130, 148, 240, 0), cv::Scalar(150, 168, 255, 255), alarm);
    EXPECT_GT(cv::countNonZero(alarm), 5) << width << " x " << height << ": what is urgent stays";
    const std::string fourth = std::exchange(content.keys[3].second, "something else");
    EXPECT_GT(cv::norm(picture, drawn(content, width, height), cv::NORM_L1), 0)
        << width << " x " << height << ": the first keys stay";
    content.keys[3].second = fourth;
  }
}

// Page by page; from the second one on lines that are not urgent make way, but nothing is over another.
TEST(Hud, EveryKeyIsShownInTheEnd) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = "minerva: as it will be";
  content.next = {"next", "ready", "hold the switch and move", Urgency::fine};
  content.lines.assign(13, {"line", "commands act after 500 ms, round trip 1000 ms, newest image 500 ms old", ""});
  content.keys = key_words();
  for (const auto& [width, height, scale, most] : {std::tuple{1280, 800, 1.0, 1u},
                                                   {1280, 800, 2.0, 3u},
                                                   {640, 480, 1.0, 3u},
                                                   {640, 480, 2.0, 8u},
                                                   {300, 300, 1.0, 8u}}) {
    std::size_t pages = 0;
    std::optional<std::size_t> first = 0;
    while (first) {
      content.first_key = *first;
      std::size_t next = 0;
      const cv::Mat picture = drawn(content, width, height, scale, &next);
      keep(fmt::format("keys_{}x{}_{}_{}", width, height, scale, pages), picture);
      ASSERT_GT(next, *first) << width << " x " << height << " page " << pages;
      cv::Mat dark;
      cv::inRange(picture, cv::Scalar(0, 0, 0, 0), cv::Scalar(26, 26, 26, 255), dark);
      EXPECT_EQ(cv::countNonZero(dark), 0) << width << " x " << height << " page " << pages;
      EXPECT_EQ(changed(picture.colRange(width - 4, width)), 0) << "words are not cut at the window's side";
      ++pages;
      first = keys_after(first, next, content.keys.size());
      if (!first) {
        EXPECT_EQ(next, content.keys.size());
      }
    }
    EXPECT_LE(pages, most) << width << " x " << height << ", " << scale;
  }
}

// As the seat shows the newest image beside the prediction.
TEST(Hud, PicturesThatAreComparedStayClear) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = "minerva: newest image | as it will be";
  content.next = {"next", "ready", "hold the switch and move", Urgency::fine};
  content.lines.assign(11, {"line", "commands act after 500 ms, round trip 1000 ms, newest image 500 ms old", ""});
  for (const auto& [width, height] : {std::pair{1280, 800}, {1000, 700}}) {
    const int above = height / 2 - 3 * width / 16, below = height - above;  // of 4:3
    content.clear = HudRows{static_cast<double>(above), static_cast<double>(below)};
    content.keys = key_words();
    content.first_key = 0;
    while (content.first_key < content.keys.size()) {
      std::size_t next = 0;
      const cv::Mat picture = drawn(content, width, height, 1, &next);
      keep(fmt::format("compared_{}x{}_{}", width, height, content.first_key), picture);
      ASSERT_GT(next, content.first_key);
      EXPECT_EQ(changed(picture.rowRange(height - below, height - above)), 0) << width << " x " << height;
      const cv::Mat words = picture.rowRange(height - above, height);
      EXPECT_GT(changed(words.colRange(0, width / 2)), 0.2) << "lines over the left picture";
      EXPECT_GT(changed(words.colRange(width / 2, width)), 0.2) << "and over the right one";
      content.first_key = next;
    }
  }
}

TEST(Hud, WhatIsUrgentGoesOverPicturesThatAreCompared) {
  const auto context = gl::create_headless_context();
  HudContent content;
  content.title = "minerva: newest image | as it will be";
  content.lines.assign(11, {"line", "commands act after 500 ms", ""});
  content.clear = HudRows{60, 540};
  const cv::Mat without = drawn(content, 1280, 600);
  EXPECT_EQ(changed(without.rowRange(60, 540)), 0);
  content.lines.insert(content.lines.end(), 8, {"drives", "elbow: overcurrent", "reset", Urgency::trouble});
  EXPECT_GT(changed(drawn(content, 1280, 600).rowRange(60, 540)), 0.02);
  content.lines.clear();
  content.keys = key_words();
  std::size_t shown = 0;
  drawn(content, 1280, 600, 1, &shown);
  EXPECT_EQ(shown, 4u) << "the first of them, such as the one that stops the robot";
}

TEST(Hud, AskingForKeysGoesRound) {
  EXPECT_EQ(keys_after(std::nullopt, 0, 20), 0u);
  EXPECT_EQ(keys_after(0, 8, 20), 8u);
  EXPECT_EQ(keys_after(8, 20, 20), std::nullopt);
  EXPECT_EQ(keys_after(0, 0, 20), std::nullopt) << "there was no room for any";
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
