#include "apps/replay_report/html_report.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "apps/replay_report/report_plots.hpp"
#include "common/error.hpp"
#include "common/svg_plot.hpp"
#include "tests/replay_report/example_run.hpp"
#include "tests/scene/test_run.hpp"
#include "tests/support/html_check.hpp"

namespace foresight::html_report_test {
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

TEST(HtmlReport, TheSeriesOfItsPlotsLieBesideIt) {
  const TempFolder folder;
  RunRecord run = example_run(4);
  run.run = "a \"run\"\xff";
  run.frames[2].dropped = true;
  write_html_report(run, example_instants(run), folder / "report.html");
  const auto all = nlohmann::json::parse(folder.read("report.html.plots.json"));
  ASSERT_EQ(all["plots"].size(), 8u);
  const auto& quality = all["plots"][0];
  EXPECT_EQ(quality["y"]["unit"], "dB");
  for (const auto& series : quality["series"]) {
    const bool predicted = series["name"] == "predicted";
    EXPECT_TRUE(predicted || series["name"] == "delayed") << series["name"];
    for (std::size_t i = 0; i < 4; ++i) {
      const FrameRecord& f = run.frames[i];
      EXPECT_NEAR(series["x"][i].get<double>(), f.time_s - run.frames[0].time_s, 1e-9);
      if (f.dropped)
        EXPECT_TRUE(series["y"][i].is_null()) << "not measured";
      else
        EXPECT_DOUBLE_EQ(series["y"][i].get<double>(), (predicted ? f.predicted : f.delayed).psnr_db.value());
    }
  }
  for (const auto& plot : all["plots"]) EXPECT_FALSE(plot["series"].empty()) << plot["title"];
}

TEST(HtmlReport, APipeGetsThePageOnly) {
  const TempFolder folder;
  const auto pipe = folder / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(plot_data_file(pipe));
  EXPECT_EQ(plot_data_file(folder / "a.html"), folder / "a.html.plots.json");
}

TEST(RoundTicks, AreRoundAndInsideTheRange) {
  EXPECT_THAT(round_ticks({0, 100}, 4), ElementsAre(0, 25, 50, 75, 100));
  EXPECT_THAT(round_ticks({-0.9, 2.1}, 3), ElementsAre(0, 1, 2));
  EXPECT_THAT(round_ticks({7.3, 23}, 4), ElementsAre(10, 15, 20));
}

TEST(SvgPlot, DataIsWhatWasDrawn) {
  SvgPlot plot("p", {0, 4}, {0, 1}, "s", "dB");
  const double x[] = {0, 1}, y[] = {0.1, NAN}, high[] = {0.5, 0.75};
  plot.line(x, y, "k0", "measured");
  plot.area(x, x, high, "k1");
  plot.bar({0, 1}, {0, 0.25}, "k2", "bars");
  plot.bar({1, 2}, {0, 0.5}, "k2", "bars");
  plot.mark_x(3, "p50", "m");
  const auto data = nlohmann::json::parse(plot.data());
  EXPECT_EQ(data, nlohmann::json::parse(R"({"title": "p", "x": {"unit": "s", "range": [0, 4]},
      "y": {"unit": "dB", "range": [0, 1]}, "series": [
        {"name": "measured", "kind": "line", "x": [0, 1], "y": [0.1, null]},
        {"name": "k1", "kind": "area", "x": [0, 1], "low": [0, 1], "high": [0.5, 0.75]},
        {"name": "bars", "kind": "bars", "left": [0, 1], "right": [1, 2], "low": [0, 0], "high": [0.25, 0.5]}],
      "marks": [{"axis": "x", "at": 3, "text": "p50"}]})"));
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
}  // namespace foresight::html_report_test
