#include "prediction/line_delay.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "common/statistics.hpp"
#include "common/text_rows.hpp"
#include "tests/support/folders.hpp"

namespace foresight::line_delay_test {
namespace {

struct Outcome {
  double p95 = 0, newest_p95 = 0,
         mean_p95 = 0;  // errors of the prediction; of the newest delay; of the mean of all so far
  double inside = 0;
};

Outcome predicted(const std::vector<double>& delays, double step) {
  LineDelay line;
  std::vector<double> ours, newest, mean;
  std::size_t inside = 0;
  double sum = 0;
  for (std::size_t i = 0; i < delays.size(); ++i) {
    const double time = static_cast<double>(i) * step;
    if (i >= 500) {
      const PredictedDelay next = line.at(time);
      EXPECT_TRUE(next.valid);
      ours.push_back(std::abs(next.seconds - delays[i]));
      newest.push_back(std::abs(delays[i - 1] - delays[i]));
      mean.push_back(std::abs(sum / static_cast<double>(i) - delays[i]));
      inside += ours.back() <= 2 * next.sigma;
    }
    EXPECT_TRUE(line.add(time, delays[i]));
    sum += delays[i];
  }
  return {quantile(ours, 0.95), quantile(newest, 0.95), quantile(mean, 0.95),
          static_cast<double>(inside) / static_cast<double>(ours.size())};
}

TEST(LineDelay, JitterIsAveragedAndQueuesAreFollowed) {
  std::mt19937 random(1);
  std::exponential_distribution<double> late(1 / 0.01);
  std::vector<double> jitter, queue;
  double length = 0;
  std::normal_distribution<double> change(0, 0.002);
  for (int i = 0; i < 6000; ++i) {
    jitter.push_back(0.25 + late(random));
    length = std::clamp(length + change(random), 0.0, 0.2);
    queue.push_back(0.05 + length);
  }
  const Outcome of_jitter = predicted(jitter, 0.01), of_queue = predicted(queue, 0.01);
  EXPECT_LT(of_jitter.p95, 0.9 * of_jitter.newest_p95);
  EXPECT_LT(of_queue.p95, 0.2 * of_queue.mean_p95);
  EXPECT_LT(of_queue.p95, 1.1 * of_queue.newest_p95);
  for (const Outcome& outcome : {of_jitter, of_queue}) {
    EXPECT_GE(outcome.inside, 0.90);
    EXPECT_LE(outcome.inside, 0.98);
  }
}

TEST(LineDelay, ARecordedLineIsKnownAsSurelyAsItSays) {
  const std::filesystem::path csv = data_folder() / "line_traces/starlink.csv";
  if (!std::filesystem::exists(csv)) GTEST_SKIP() << "no recorded line in " << csv;
  std::vector<double> up;
  bool header = true;
  for_each_row(csv, {RowForm::Between::commas}, [&](const TextRow& row) {
    if (!std::exchange(header, false)) up.push_back(finite_field(row, 1, "up_delay_ms") * 1e-3);
  });
  const Outcome outcome = predicted(up, 0.01);
  EXPECT_LT(outcome.p95, 0.9 * outcome.mean_p95);
  EXPECT_GE(outcome.inside, 0.90);
  EXPECT_LE(outcome.inside, 0.98);
}

TEST(LineDelay, WrongDelaysAreNotTakenAndSilenceSaysNothing) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  LineDelay line;
  EXPECT_FALSE(line.at(0).valid);
  EXPECT_FALSE(line.add(0, kNan));
  EXPECT_FALSE(line.add(kNan, 0.1));
  EXPECT_FALSE(line.add(0, -0.1));
  EXPECT_FALSE(line.add(0, 100));
  EXPECT_TRUE(line.add(1, 0.1));
  EXPECT_FALSE(line.add(0.9, 0.1));
  EXPECT_TRUE(line.at(1.5).valid);
  EXPECT_NEAR(line.at(1.5).seconds, 0.1, 1e-12);
  EXPECT_FALSE(line.at(2.5).valid);
  EXPECT_FALSE(line.at(kNan).valid);
}

}  // namespace
}  // namespace foresight::line_delay_test
