#include "link/send_control/redundancy.hpp"

#include <algorithm>

#include "link/send_control/erasure_code.hpp"

namespace foresight {
namespace {

constexpr double kWorth = 6;  // of a picture's bytes, for each second that it comes later
constexpr std::size_t kRemembered = 100, kToKnow = 20, kMostTrips = 64;

}  // namespace

void Redundancy::sent(std::uint32_t pair, std::size_t pieces) {
  trips_[pair] = {.pieces = pieces};
  if (trips_.size() > kMostTrips) trips_.erase(trips_.begin());
}

void Redundancy::came(std::uint32_t pair) {
  const auto trip = trips_.find(pair);
  if (trip == trips_.end()) return;
  ++trip->second.came;
  settle(trip);
}

void Redundancy::lost(std::uint32_t pair) {
  const auto trip = trips_.find(pair);
  if (trip == trips_.end()) return;
  ++trip->second.lost;
  settle(trip);
}

void Redundancy::settle(std::map<std::uint32_t, Trip>::iterator trip) {
  const auto& [pieces, came, lost] = trip->second;
  if (came + lost < pieces) return;
  lost_shares_.push_back(static_cast<double>(lost) / static_cast<double>(pieces));
  if (lost_shares_.size() > kRemembered) lost_shares_.pop_front();
  trips_.erase(trip);
}

std::size_t Redundancy::spares(std::size_t pieces, double round_trip_s) const {
  const double known = static_cast<double>(std::max(lost_shares_.size(), kToKnow));
  std::size_t best = 0;
  double least = 0;
  for (std::size_t spares = 0; spares <= pieces / 2 + pieces % 2 && pieces + spares <= kMostCodedPieces; ++spares) {
    const double share = static_cast<double>(spares) / static_cast<double>(pieces + spares);
    const auto missed =
        std::count_if(lost_shares_.begin(), lost_shares_.end(), [share](double lost) { return lost > share + 1e-9; });
    const double cost = share + kWorth * round_trip_s * static_cast<double>(missed) / known;
    if (spares == 0 || cost < least) {
      best = spares;
      least = cost;
    }
  }
  return best;
}

}  // namespace foresight
