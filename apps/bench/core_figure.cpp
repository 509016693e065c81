#include "apps/bench/core_figure.hpp"

#include <opencv2/imgproc.hpp>

#include "apps/bench/figure_subjects.hpp"
#include "apps/replay_report/contact_sheet.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "display/recorded_source.hpp"
#include "display/view_session.hpp"
#include "pictures/image_metrics.hpp"

namespace foresight {
namespace {

constexpr Duration kDelay{500'000'000};
constexpr Duration kEnough{1'500'000'000};  // so long, at most, before the instant that is shown

struct Instants {
  std::size_t shown = 0, arrived = 0;  ///< frame shown; how many frames have arrived by then
};

Instants choose_instants(const RunFolder& run) {
  const auto& frames = run.frames();
  const RobotTime start = frames.front().left.time;
  Instants out;
  while (out.shown + 1 < frames.size() && frames[out.shown].left.time - start < kEnough) ++out.shown;
  const RobotTime sent = frames[out.shown].left.time - kDelay;
  while (out.arrived < frames.size() && frames[out.arrived].left.time <= sent) ++out.arrived;
  if (out.arrived == 0)
    throw InputError(run.root().string(), "all of its images are less than 500 ms apart",
                     "take a longer run; core and thesis are compared at that delay");
  return out;
}

cv::Mat view_of(const RunFolder& run, const TextureOptions& core, const std::optional<thesis::Options>& thesis,
                const Instants& instants) {
  const auto context = gl::create_headless_context();
  ViewSession session(*context, view_setup(run, core, thesis));
  for (std::size_t i = 0; i < instants.arrived; ++i) session.process(load_posed_frame(run, i, core.margin_px));
  const RunImage& shown = run.frames()[instants.shown].left;
  session.draw(shown.T_world_camera, run.state_at(shown.time));
  return session.read();
}

/// Where the actual image has most structure: a detail that favours nobody.
cv::Rect structured_detail(const cv::Mat& actual, const cv::Mat& where) {
  cv::Mat grey, x, y, slope;
  cv::cvtColor(actual, grey, cv::COLOR_BGR2GRAY);
  cv::Sobel(grey, x, CV_32F, 1, 0);
  cv::Sobel(grey, y, CV_32F, 0, 1);
  slope = cv::min(cv::abs(x) + cv::abs(y), 255.0f);
  slope.convertTo(grey, CV_8U);
  grey.setTo(0, where == 0);
  return choose_detail(grey);
}

}  // namespace

FigurePage core_figure(const RunFolder& run, const TextureOptions& core) {
  const Instants instants = choose_instants(run);
  const cv::Mat actual = as_colour(read_run_image(run.frames()[instants.shown].left, run.lens_left()));
  const cv::Mat views[] = {view_of(run, core, thesis::Options{}, instants), view_of(run, core, std::nullopt, instants)};
  // Over the same pixels: those that both have colours for that a camera saw.
  const cv::Mat both = seen_mask(views[0]) & seen_mask(views[1]);
  const ImageComparison comparison(actual, both);
  const cv::Rect detail = structured_detail(actual, both);
  FigurePage page{"Core and thesis, delay 500 ms: " + std::to_string(instants.arrived) +
                      " images have arrived. PSNR over the pixels that both have camera colours for (" +
                      readable(100.0 * cv::countNonZero(both) / static_cast<double>(both.total()), 0, " %)"),
                  3,
                  {{outlined(actual, detail), "What the camera sees (image " + std::to_string(instants.shown) + ")"}}};
  const char* names[] = {"Thesis (3 shader iterations, pyramid): ", "Core (default options): "};
  for (int i = 0; i < 2; ++i)
    page.panels.push_back({outlined(pink_holes(views[i]), detail),
                           names[i] + readable(comparison.psnr_db(views[i]), 1, " dB, camera colours on ") +
                               readable(100 * measure_coverage(views[i]).seen, 1, " % of the picture")});
  page.panels.push_back({enlarged(actual, detail, kDetailFactor), "Detail with the most structure, enlarged 4 times"});
  for (const cv::Mat& view : views)
    page.panels.push_back({enlarged(pink_holes(view), detail, kDetailFactor), "The same detail"});
  return page;
}

}  // namespace foresight
