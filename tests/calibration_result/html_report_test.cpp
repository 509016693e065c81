#include "calibration/result/html_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "calibration/result/frame_drawing.hpp"
#include "calibration/result/heat_map.hpp"
#include "common/error.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/html_check.hpp"

namespace foresight::html_report_test {
namespace {

using testing::HasSubstr;
using testing::Not;

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

HtmlReport example() {
  HtmlReport report("left <4021> & right");
  report.heading("Where the \"corners\" <lie>");
  report.paragraph("a < b & c > d");
  report.table({"view", "RMS"}, {{"left01.jpg", "0.181 px"}, {"<img src=x>", "-"}});
  report.plot("Residuals <all>", "u & v", "px",
              {{"kept", {{0.1, 0.2}, {-0.3, 0.1}}}, {"fit", {{-1, 0}, {1, 0.5}}, true}}, true);
  cv::Mat values(12, 16, CV_64F);
  for (int y = 0; y < values.rows; ++y)
    for (int x = 0; x < values.cols; ++x) values.at<double>(y, x) = 0.1 + 0.001 * (x - 8) * (x - 8);
  values.at<double>(0, 0) = NAN;
  report.heat_map("Projection uncertainty", values, 640, 480, "px");
  return report;
}

// Frames that stand apart in space stand apart on paper, each with its name.
TEST(FrameDrawing, DrawsFramesCamerasAndAGrid) {
  FrameDrawing drawing;
  Pose T = Pose::Identity();
  drawing.frame("base <a>", T, 0.2);
  T.translation() = Eigen::Vector3d(0.5, 0.3, 0.4);
  drawing.frame("camera", T, 0.1);
  drawing.camera("", T, 0.6, 0.4, 0.2);
  drawing.dot({0.1, 0.1, 0.1}, "k3");
  HtmlReport report("Frames");
  report.drawing("Where everything stands", drawing.svg("frames"));
  report.pictures({{cv::Mat(30, 40, CV_8UC3, cv::Scalar(9, 90, 200)), "view 3", "0.2 px & more"}});
  report.places("Left", {{"left", {{10, 10}}, false}}, 640, 480);
  Verdict verdict;
  verdict.object("the board <moved>", "hold it still");
  report.verdict(verdict);
  const TempFolder folder;
  report.write(folder / "r.html");
  const std::string page = folder.read("r.html");
  EXPECT_EQ(malformed(page), "");
  for (const char* text : {"base &lt;a&gt;", ">camera<", "grid: 0.2 m", "data:image/jpeg;base64,", "0.2 px &amp; more",
                           "the board &lt;moved&gt;", "hold it still"})
    EXPECT_THAT(page, HasSubstr(text));
  EXPECT_LT(page.find("Not usable"), page.find("Where everything stands"));
  EXPECT_THAT(page, HasSubstr(">400<")) << "the whole image, not only where points are";
  EXPECT_EQ(FrameDrawing().svg("nothing"), "");
}

TEST(HtmlReport, IsWellFormedSelfContainedAndEscaped) {
  const TempFolder folder;
  example().write(folder / "report.html");
  const std::string html = folder.read("report.html");
  EXPECT_EQ(malformed(html), "");
  EXPECT_THAT(html, Not(HasSubstr("http")));
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("url(")));
  EXPECT_THAT(html, HasSubstr("<title>left &lt;4021&gt; &amp; right</title>"));
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme: dark"));
  EXPECT_THAT(html, Not(HasSubstr("<img src=x>")));
  EXPECT_THAT(html, HasSubstr("a &lt; b &amp; c &gt; d"));
}

TEST(HtmlReport, TheSeriesOfItsPlotsLieBesideIt) {
  const TempFolder folder;
  example().write(folder / "report.html");
  const auto all = nlohmann::json::parse(folder.read("report.html.plots.json"));
  EXPECT_EQ(all["title"], "left <4021> & right");
  ASSERT_EQ(all["plots"].size(), 2u);
  const auto& kept = all["plots"][0]["series"][0];
  EXPECT_EQ(kept["name"], "kept");
  EXPECT_EQ(kept["kind"], "dots");
  EXPECT_EQ(kept["x"], (std::vector<double>{0.1, -0.3}));
  EXPECT_EQ(all["plots"][0]["series"][1]["y"], (std::vector<double>{0, 0.5}));
  const auto& map = all["plots"][1];
  EXPECT_EQ(map["size_px"], (std::vector<int>{640, 480}));
  ASSERT_EQ(map["cells"].size(), 12u);
  EXPECT_TRUE(map["cells"][0][0].is_null());
  EXPECT_DOUBLE_EQ(map["cells"][11][15].get<double>(), 0.1 + 0.001 * 49);
  HtmlReport words("words");
  words.write(folder / "words.html");
  EXPECT_FALSE(std::filesystem::exists(folder / "words.html.plots.json")) << "it has no plot";
}

TEST(HtmlReport, FiguresStandToTheRight) {
  HtmlReport report("t");
  report.table({"view", "RMS"}, {{"left01.jpg", "0.181 px"}, {"left02.jpg", "-"}});
  EXPECT_THAT(report.body(), HasSubstr("<td>left01.jpg</td><td class=\"n\">0.181 px</td>"));
  EXPECT_THROW(report.table({"a", "b"}, {{"1"}}), std::invalid_argument);
}

TEST(HtmlReport, DrawsEveryDotAndNoneThatIsNotFinite) {
  HtmlReport report("t");
  report.plot("c", "u", "v", {{"s", {{0, 0}, {1, 1}, {NAN, 1}, {2, INFINITY}, {2, 0.5}}}});
  EXPECT_EQ(count(report.body(), "h0"), 3u);
  HtmlReport empty("t");
  empty.plot("c", "u", "v", {{"nothing", {}}});
  EXPECT_EQ(count(empty.body(), "h0"), 0u);
  EXPECT_EQ(malformed(empty.body()), "");
}

// The corners of a square, drawn to equal scale, are the corners of a square on the page, y down.
TEST(HtmlReport, EqualScaleKeepsASquareSquare) {
  HtmlReport report("t");
  report.plot("c", "u", "v", {{"s", {{0, 0}, {0, 100}}}, {"t", {{100, 0}}}}, true);
  double x0, y0, x1, y1, x2, y2;
  const std::string body = report.body();
  const auto first = body.find("d=\"M"), second = body.find("d=\"M", first + 1);
  ASSERT_NE(second, std::string::npos);
  ASSERT_EQ(std::sscanf(body.c_str() + first, "d=\"M%lf %lfh0M%lf %lfh0", &x0, &y0, &x1, &y1), 4);
  ASSERT_EQ(std::sscanf(body.c_str() + second, "d=\"M%lf %lfh0", &x2, &y2), 2);
  EXPECT_DOUBLE_EQ(x0, x1);
  EXPECT_DOUBLE_EQ(y0, y2);
  EXPECT_GT(y1, y0 + 100) << "a larger v lies lower";
  EXPECT_NEAR(y1 - y0, x2 - x0, 0.15) << "places are written to 0.1";
}

TEST(HeatMap, ColoursFollowTheValuesAndGapsStayEmpty) {
  cv::Mat values = (cv::Mat_<double>(1, 3) << 1, 2, NAN);
  const std::string svg = heat_map_svg("map", values, 300, 100, "px");
  const std::string mark = "href=\"data:image/png;base64,";
  const auto at = svg.find(mark) + mark.size();
  const std::string text = svg.substr(at, svg.find('"', at) - at);
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uchar> png;
  unsigned bits = 0, held = 0;
  for (const char c : text.substr(0, text.find('='))) {
    bits = bits << 6 | static_cast<unsigned>(digits.find(c));
    if ((held += 6) >= 8) png.push_back(static_cast<uchar>(bits >> (held -= 8)));
  }
  const cv::Mat picture = cv::imdecode(png, cv::IMREAD_UNCHANGED);
  ASSERT_EQ(picture.size(), cv::Size(3, 1));
  const auto brightness = [&](int x) {
    const auto c = picture.at<cv::Vec4b>(0, x);
    return c[0] + c[1] + c[2];
  };
  EXPECT_LT(brightness(0) + 100, brightness(1));
  EXPECT_EQ(picture.at<cv::Vec4b>(0, 0)[3], 255);
  EXPECT_EQ(picture.at<cv::Vec4b>(0, 2)[3], 0);
}

TEST(HeatMap, TakesConstantAndEmptyMapsAndRefusesOthers) {
  EXPECT_EQ(malformed(heat_map_svg("m", cv::Mat(3, 4, CV_64F, cv::Scalar(0.2)), 640, 480, "px")), "");
  EXPECT_EQ(malformed(heat_map_svg("m", cv::Mat(3, 4, CV_64F, cv::Scalar(0)), 640, 480, "px")), "");
  EXPECT_EQ(malformed(heat_map_svg("m", cv::Mat(3, 4, CV_64F, cv::Scalar(NAN)), 640, 480, "px")), "");
  EXPECT_THROW(heat_map_svg("m", cv::Mat(3, 4, CV_32F), 640, 480, "px"), std::invalid_argument);
  EXPECT_THROW(heat_map_svg("m", cv::Mat(), 640, 480, "px"), std::invalid_argument);
}

TEST(HtmlReport, NamesTheFileThatItCannotWrite) {
  EXPECT_THROW(example().write("/nowhere/at/all.html"), RuntimeFailure);
}

}  // namespace
}  // namespace foresight::html_report_test
