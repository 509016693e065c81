#include "apps/replay_report/html_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "apps/replay_report/report_plots.hpp"
#include "common/error.hpp"
#include "common/svg_plot.hpp"
#include "tests/replay_report/example_run.hpp"
#include "tests/support/html_check.hpp"

namespace foresight {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<Instant> example_instants(const RunRecord& run) {
  cv::Mat picture(48, 64, CV_8UC3, cv::Scalar(40, 90, 160)), predicted(48, 64, CV_8UC4, cv::Scalar(50, 80, 170, 255));
  predicted.colRange(0, 20).setTo(cv::Scalar(0, 0, 0, 0));
  InstantKeeper keeper(3);
  for (const FrameRecord& frame : run.frames) keeper.offer(frame, picture, predicted, picture);
  return keeper.instants();
}

std::size_t count(const std::string& text, const std::string& what) {
  std::size_t n = 0;
  for (auto at = text.find(what); at != std::string::npos; at = text.find(what, at + 1)) ++n;
  return n;
}

TEST(HtmlReport, IsWellFormedAndSelfContained) {
  const RunRecord run = example_run();
  const std::string html = render_html_report(run, example_instants(run));
  EXPECT_EQ(malformed(html), "");
  EXPECT_EQ(count(html, "src=\"data:image/jpeg;base64,"), 12u) << "3 instants of 4 pictures";
  EXPECT_EQ(count(html, "src="), 12u) << "nothing else is loaded";
  EXPECT_EQ(count(html, "<svg "), 8u);
  EXPECT_THAT(html, Not(HasSubstr("href=")));
  EXPECT_THAT(html, Not(HasSubstr("@import")));
  EXPECT_THAT(html, Not(HasSubstr("{{")));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
  EXPECT_THAT(html, HasSubstr("prefers-color-scheme: dark"));
}

TEST(HtmlReport, EscapesWhatComesFromOutside) {
  RunRecord run = example_run(4);
  const std::string evil = "<script>alert('x')</script>\"&{{run}}";
  run.run = run.renderer = run.lens_model = evil;
  run.notes = {evil};
  run.options = {{evil, evil}};
  for (FrameRecord& f : run.frames) f.stem = f.stages[0].name = evil;
  const std::string html = render_html_report(run, example_instants(run));
  EXPECT_THAT(html, Not(HasSubstr("<script>alert")));
  EXPECT_EQ(count(html, "<script>"), 1u);
  EXPECT_EQ(malformed(html), "");
}

TEST(HtmlReport, OfNothingIsValid) {
  RunRecord run;
  run.complete = false;
  const std::string empty = render_html_report(run, {});
  EXPECT_EQ(malformed(empty), "");
  EXPECT_THAT(empty, HasSubstr("The replay was interrupted."));
  EXPECT_THAT(empty, Not(HasSubstr("nan")));
  run = example_run(1);
  run.frames[0].predicted = run.frames[0].delayed = {};
  run.frames[0].arrival_to_publish_ms.reset();
  const std::string one = render_html_report(run, example_instants(run));
  EXPECT_EQ(malformed(one), "");
  EXPECT_THAT(one, Not(HasSubstr("nan")));
}

TEST(HtmlReport, OfALongRunStaysSmall) {
  const RunRecord run = example_run(3000);
  EXPECT_LT(render_html_report(run, {}).size(), 400'000u) << "plots are averaged into columns";
}

TEST(HtmlReport, UnwritableFolderIsAFailureThatNamesTheFile) {
  try {
    write_html_report(RunRecord{}, {}, "/nonexistent/report.html");
    FAIL();
  } catch (const RuntimeFailure& e) {
    EXPECT_THAT(e.what(), HasSubstr("/nonexistent/report.html"));
  }
}

TEST(RoundTicks, AreRoundAndInsideTheRange) {
  EXPECT_THAT(round_ticks({0, 100}, 4), ElementsAre(0, 25, 50, 75, 100));
  EXPECT_THAT(round_ticks({-0.9, 2.1}, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(round_ticks({7.3, 23}, 4), ElementsAre(10, 15, 20));
}

TEST(SvgPlot, LeavesGapsAndDrawsLonelyPoints) {
  SvgPlot plot("a <b>", {0, 4}, {0, 1}, "s", "dB");
  const double x[] = {0, 1, 2, 3, 4}, y[] = {0.1, 0.2, NAN, 0.4, NAN};
  plot.line(x, y, "k0");
  const std::string svg = plot.str();
  EXPECT_EQ(count(svg, "<polyline"), 1u);
  EXPECT_EQ(count(svg, "<circle"), 1u);
  EXPECT_THAT(svg, HasSubstr("aria-label=\"a &lt;b&gt;\""));
  EXPECT_EQ(malformed(svg), "");
  EXPECT_EQ(malformed(SvgPlot("flat", {NAN, NAN}, {3, 3}, "", "").str()), "");
}

}  // namespace
}  // namespace foresight
