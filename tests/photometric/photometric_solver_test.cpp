#include "calibration/photometric/photometric_solver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"
#include "tests/photometric/synthetic_camera.hpp"

namespace foresight::photometric_solver_test {
namespace {

using testing::HasSubstr;

const std::vector<double> kSeries{0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2};

// Largest relative error of g, over the levels that images are made of, at the best common factor (which no
// series can tell).
double worst_response(const Response& found, const std::function<double(double)>& truth) {
  double sum = 0;
  int count = 0;
  for (int v = 10; v <= 245; ++v, ++count) sum += std::log(found.inverse(v) / truth(v / 255.0));
  double worst = 0;
  for (int v = 10; v <= 245; ++v)
    worst = std::max(worst, std::abs(found.inverse(v) / truth(v / 255.0) / std::exp(sum / count) - 1));
  return worst;
}

SeriesSamples example(const SyntheticCamera& camera, unsigned seed) {
  SeriesSamples samples;
  add_static(series_of(camera, hills(320, 240), kSeries, seed), 300, samples);
  add_flat(series_of(camera, cv::Mat(240, 320, CV_64F, cv::Scalar(0.5)), {0.3, 1.2}, seed + 1), {159.5, 119.5},
           samples);
  return samples;
}

TEST(Photometric, RecoversResponseAndVignettingWithinTwoPercent) {
  const std::pair<std::function<double(double)>, std::function<double(double)>> responses[] = {
      {srgb, srgb_inverse},
      {[](double e) { return std::pow(e, 1 / 1.8); }, [](double v) { return std::pow(v, 1.8); }},
      {[](double e) { return e; }, [](double v) { return v; }},
      {[](double e) { return (1 - std::exp(-2.5 * e)) / (1 - std::exp(-2.5)); },
       [](double v) { return -std::log(1 - v * (1 - std::exp(-2.5))) / 2.5; }}};
  unsigned seed = 1;
  for (const auto& [response, inverse] : responses) {
    SyntheticCamera camera;
    camera.response = response;
    PhotometricOptions options;
    options.held_out = seed == 1;  // its error is the camera's noise whatever the curve
    const PhotometricSummary summary = solve_photometric(example(camera, seed++).samples, options);
    EXPECT_LT(worst_response(summary.response, inverse), 0.02) << "curve " << seed;
    ASSERT_TRUE(summary.has_vignetting);
    for (double r = 0; r <= 1; r += 0.05)
      EXPECT_NEAR(summary.vignetting(r * r) / camera.vignette(r * r), 1, 0.02) << "radius " << r;
    if (options.held_out) {
      EXPECT_LT(summary.held_out_levels, 1.5);
    }
    EXPECT_GT(summary.corner_sigma, 0);
    EXPECT_LT(summary.corner_sigma, 0.01);
    EXPECT_THAT(summary.warnings, testing::IsEmpty());
    EXPECT_TRUE(summary.verdict.usable()) << summary.verdict.text();
    RecordProperty("worst_response_" + std::to_string(seed), std::to_string(worst_response(summary.response, inverse)));
  }
}

TEST(Photometric, ASeriesOfAFlatFieldAloneGivesBoth) {
  const SyntheticCamera camera;
  SeriesSamples samples;
  std::vector<double> exposures;  // the curve is known where levels were seen: from 13 up, without gaps
  for (double t = 0.008; t < 2; t *= std::sqrt(2)) exposures.push_back(t);
  add_flat(series_of(camera, cv::Mat(240, 320, CV_64F, cv::Scalar(0.5)), exposures, 8), {159.5, 119.5}, samples);
  PhotometricOptions options;
  options.held_out = false;
  const PhotometricSummary summary = solve_photometric(samples.samples, options);
  EXPECT_LT(worst_response(summary.response, srgb_inverse), 0.02);
  EXPECT_NEAR(summary.vignetting(1) / camera.vignette(1), 1, 0.02);
}

TEST(Photometric, TheErrorLiesWithinItsSigma) {
  SyntheticCamera camera;
  int inside = 0, all = 0;
  for (unsigned seed = 20; seed < 30; ++seed) {
    PhotometricOptions options;
    options.held_out = false;
    const PhotometricSummary summary = solve_photometric(example(camera, seed).samples, options);
    inside += std::abs(summary.vignetting(1) - camera.vignette(1)) < 3 * summary.corner_sigma;
    ++all;
  }
  EXPECT_GE(inside, all - 1);
}

TEST(Photometric, ResponseIsMonotoneAndItsOwnInverse) {
  PhotometricOptions options;
  options.held_out = false;
  const Response response = solve_photometric(example({}, 3).samples, options).response;
  const auto table = response.table();
  ASSERT_EQ(table.size(), 256u);
  EXPECT_EQ(table[0], 0);
  EXPECT_DOUBLE_EQ(table[255], 1);
  for (std::size_t v = 1; v < 256; ++v) EXPECT_GT(table[v], table[v - 1]);
  for (int v = 1; v < 256; v += 7) EXPECT_NEAR(response.level(table[static_cast<std::size_t>(v)]), v, 1e-9);
  const Response power = Response::power_law(2.2);
  EXPECT_NEAR(power.inverse(100), std::pow(100 / 255.0, 2.2), 1e-12);
  EXPECT_NEAR(power.inverse(2), std::pow(2 / 255.0, 2.2), 1e-12);
}

TEST(Photometric, NamesWhatIsMissing) {
  const auto refusal = [](const std::vector<double>& exposures) -> std::string {
    SeriesSamples samples;
    add_static(series_of({}, hills(160, 120), exposures, 1), 200, samples);
    try {
      solve_photometric(samples.samples);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(refusal({0.5}), HasSubstr("one exposure only"));
  EXPECT_THAT(refusal({0.5, 0.5, 0.5}), HasSubstr("one exposure only"));
  EXPECT_THAT(refusal({0.5, 0.6}), HasSubstr("1.20 times"));
  EXPECT_THAT(refusal({1000, 3000}), HasSubstr("neither dark nor saturated"));
}

TEST(Photometric, ObjectsWhenTheSceneMoves) {
  SeriesSamples samples;
  auto series = series_of({}, hills(320, 240), kSeries, 5);
  for (std::size_t i = 0; i < series.size(); i += 2) cv::flip(series[i].pixels, series[i].pixels, 1);
  add_static(series, 300, samples);
  PhotometricOptions options;
  options.held_out = false;
  EXPECT_THAT(solve_photometric(samples.samples, options).verdict.text(), HasSubstr("in the scene moved"));
}

TEST(Photometric, ObjectsToPicturesThatDoNotGetBrighter) {
  auto series = series_of({}, hills(320, 240), kSeries, 6);
  Verdict proper;
  judge_series(series, proper);
  EXPECT_TRUE(proper.usable());
  for (ExposedImage& image : series) image.pixels = series[3].pixels;
  SeriesSamples samples;
  add_static(series, 300, samples);
  PhotometricOptions options;
  options.held_out = false;
  EXPECT_THAT(solve_photometric(samples.samples, options).verdict.text(),
              testing::AllOf(HasSubstr("only 0 % of the places are brighter"), HasSubstr("automatic exposure")));
  Verdict same;
  judge_series(series, same);
  EXPECT_THAT(same.text(), testing::AllOf(HasSubstr("are the same"), HasSubstr("image0.png and image1.png")));
}

}  // namespace
}  // namespace foresight::photometric_solver_test
