// Made-up mobile lines, seeded: none is any recorded one.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "link/line/line_spec.hpp"

namespace foresight {

struct SyntheticLine {
  std::string name;
  LineSpec line;
  double mean_mbit = 0;
};

namespace synthetic {

inline double uniform(std::mt19937_64& random) {
  return static_cast<double>(random() >> 11) * 0x1p-53;
}
inline double normal(std::mt19937_64& random) {
  return std::sqrt(-2 * std::log(uniform(random) + 0x1p-54)) * std::cos(2 * std::numbers::pi * uniform(random));
}

constexpr int kStep_ms = 10;

/// Chances of 1,500 bytes from a rate per 10 ms, in Mbit/s, scaled to a mean.
inline std::shared_ptr<const Trace> deliveries(std::vector<double> rates, double mean_mbit, std::mt19937_64& random,
                                               int grid_ms) {
  double sum = 0;
  for (const double rate : rates) sum += rate;
  const double scale = mean_mbit * static_cast<double>(rates.size()) / sum;
  DeliveryTrace trace;
  double owed = 0;
  for (std::size_t i = 0; i < rates.size(); ++i)
    for (int ms = 0; ms < kStep_ms; ++ms) {
      const auto at = static_cast<std::uint32_t>(static_cast<int>(i) * kStep_ms + ms);
      owed += scale * rates[i] * 125.0 / 1500.0 * (0.5 + uniform(random));
      if (at % static_cast<std::uint32_t>(grid_ms) != 0) continue;
      for (; owed >= 1; owed -= 1) trace.at_ms.push_back(at);
    }
  trace.at_ms.push_back(static_cast<std::uint32_t>(rates.size()) * kStep_ms);
  return std::make_shared<const Trace>(std::move(trace));
}

/// Log-normal, slowly changing: `tau_s`, `sigma` of the logarithm.
inline std::vector<double> wandering(std::size_t steps, double tau_s, double sigma, std::mt19937_64& random) {
  std::vector<double> rates(steps);
  const double keep = std::exp(-0.001 * kStep_ms / tau_s), fresh = sigma * std::sqrt(1 - keep * keep);
  double x = sigma * normal(random);
  for (double& rate : rates) {
    x = keep * x + fresh * normal(random);
    rate = std::exp(x);
  }
  return rates;
}

/// Nothing crosses, from time to time: `every_s` and `for_s` on average, both exponentially spread.
inline void cut(std::vector<double>& rates, double every_s, double for_s, double left, std::mt19937_64& random) {
  const auto steps = [&](double mean_s) {
    return static_cast<std::size_t>(-std::log(1 - uniform(random)) * mean_s * 1000 / kStep_ms) + 1;
  };
  for (std::size_t i = steps(every_s); i < rates.size(); i += steps(every_s))
    for (std::size_t end = std::min(rates.size(), i + steps(for_s)); i < end; ++i) rates[i] *= left;
}

}  // namespace synthetic

/// One line of each kind for `seed`, of `length_s`; 20 ms each way.
inline std::vector<SyntheticLine> synthetic_lines(unsigned seed, double length_s = 60) {
  using namespace synthetic;
  std::vector<SyntheticLine> out;
  const auto steps = static_cast<std::size_t>(length_s * 1000 / kStep_ms);
  std::mt19937_64 random(seed * 7919 + 17);
  const auto add = [&](std::string name, std::vector<double> rates, double mean, int grid, double loss = 0,
                       double burst = 1) {
    LineSpec line;
    line.seed = seed;
    line.up.delay = line.down.delay = std::chrono::milliseconds(20);
    line.up.trace = deliveries(std::move(rates), mean, random, grid);
    line.up.loss = loss;
    line.up.burst = burst;
    out.push_back({std::move(name), line, mean});
  };
  add("walking", wandering(steps, 1.5, 0.5, random), 1.5, 1);
  auto drive = wandering(steps, 0.5, 0.9, random);
  cut(drive, 6, 0.25, 0.0, random);
  add("driving", drive, 1.2, 10);
  auto train = wandering(steps, 3, 0.5, random);
  cut(train, 15, 1.2, 0.0, random);
  cut(train, 4, 0.5, 0.15, random);
  add("train", train, 1.0, 5);
  auto satellite = wandering(steps, 5, 0.2, random);
  for (std::size_t i = 0; i < steps; i += 1500)
    for (std::size_t k = 0; k < 15 && i + k < steps; ++k) satellite[i + k] = 0;
  add("satellite, 1 % lost", satellite, 1.9, 2, 0.01, 3);
  std::vector<double> on_off(steps);
  bool on = true;
  for (double& rate : on_off) {
    if (uniform(random) < (on ? 1 / 40.0 : 1 / 25.0)) on = !on;
    rate = on ? 1 : 0;
  }
  add("on and off", on_off, 1.4, 5);
  std::vector<double> ramp(steps);
  for (std::size_t i = 0; i < steps; ++i) ramp[i] = 0.2 + 1.5 * (1 - static_cast<double>(i % 700) / 700);
  add("ramps down", ramp, 1.1, 5);
  std::vector<double> fades(steps);
  for (std::size_t i = 0; i < steps; ++i)
    fades[i] = std::pow(0.02 + std::pow(std::sin(0.01 * static_cast<double>(i) / 1.1), 2), 1.3);
  add("deep fades", fades, 0.8, 10);
  add("thin and even, 3 % lost", std::vector<double>(steps, 1.0), 0.8, 10, 0.03, 2);
  add("fast, wandering", wandering(steps, 1.0, 0.8, random), 12, 1);
  auto middle = wandering(steps, 0.7, 0.9, random);
  cut(middle, 9, 0.1, 0.0, random);
  add("middling", middle, 5, 1);
  return out;
}

}  // namespace foresight
