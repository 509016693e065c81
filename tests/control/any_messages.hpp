// Messages of control with any contents: small numbers, large ones, and those that somebody who listens would know.
#pragma once

#include <limits>
#include <random>

#include "tests/control/small_line.hpp"

namespace foresight {

/// Seeded.
class AnyMessages {
 public:
  FromOperator from_operator() {
    FromOperator out{any(), any(), ClockPing{any()}};
    switch (random_() % 8) {
      case 0: out.body = Hello{identity()}; break;
      case 1: out.body = ClockPong{any(), signed_any(), signed_any()}; break;
      case 2: out.body = Ask{any()}; break;
      case 3: out.body = GiveBack{any()}; break;
      case 4: out.body = HandOver{any(), any()}; break;
      case 5:
        out.body =
            SetPoint{any(), any(), any(), {signed_any()}, Duration(signed_any()), any() % 2 == 0, any(), positions()};
        break;
      case 6:
        out.body =
            Request{any(), static_cast<LineRequest>(any()), any(), any(), {signed_any()}, Duration(signed_any())};
        break;
      default: break;
    }
    return out;
  }
  FromRobot from_robot() {
    FromRobot out{any(), any(), ClockPing{any()}};
    switch (random_() % 6) {
      case 0: out.body = Welcome{any(), identity(), {{"words", "cure", true}}}; break;
      case 1: out.body = ClockPong{any(), signed_any(), signed_any()}; break;
      case 2: out.body = LeaseVerdict{any(), any(), "words"}; break;
      case 3: out.body = Answer{any(), static_cast<RequestOutcome>(any() % 5)}; break;
      case 4: {
        ControlState state;
        state.sequence = any();
        state.time = {signed_any()};
        state.holder = any();
        state.consent = any();
        state.joints = any();
        state.begin = positions();
        out.body = state;
        break;
      }
      default: break;
    }
    return out;
  }
  /// The numbers that are known from now on; at least one.
  void know(std::vector<std::uint64_t> numbers) { known_ = std::move(numbers); }

 private:
  std::uint64_t any() {
    // Small, large, and those that are known.
    const std::uint64_t n = random_();
    switch (n % 4) {
      case 0: return random_() >> (n % 60);
      case 1: return n % 8;
      case 2: return known_[n / 4 % known_.size()];
      default: return ~std::uint64_t{0} - n % 3;
    }
  }
  std::int64_t signed_any() { return static_cast<std::int64_t>(any()); }
  double number() {
    const std::array values{0.0, -1.0, 0.05, 1e300, std::numeric_limits<double>::infinity(), std::nan("")};
    return values[random_() % values.size()];
  }
  LinePositions positions() {
    LinePositions out;
    for (double& p : out) p = random_() % 3 == 0 ? number() : 0.01;
    return out;
  }
  Identity identity() {
    Identity out = sample_identity(std::string(any() % 300, static_cast<char>(any())));
    if (any() % 2 == 0) out.joints.assign(any() % 40, "\n\x1b[2J");
    out.protocol = static_cast<std::uint32_t>(any());
    out.scene = any();
    return out;
  }

  std::mt19937_64 random_{1};
  std::vector<std::uint64_t> known_{1};
};

}  // namespace foresight
