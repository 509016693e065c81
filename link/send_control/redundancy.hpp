// How many pieces beyond its own a pair is sent with: as many as pay, by what became of pairs of late.
//
// A pair that misses more pieces than it has to spare comes a round trip later; what is spared takes from the picture.
// Losses come singly or in rows: so nothing is assumed of them but that the next pairs lose such shares as the last
// ones did, and what is minimised over the number of spares is
//
//   spares / (pieces + spares)  +  worth * round trip * share of the last pairs that would miss more
//
// Pure logic; one thread.
#pragma once

#include <cstdint>
#include <deque>
#include <map>

namespace foresight {

class Redundancy {
 public:
  /// `pieces` of this pair, spares among them, are sent for the first time.
  void sent(std::uint32_t pair, std::size_t pieces);
  /// What became of one of them. Of later copies, too: they do not count.
  void came(std::uint32_t pair);
  void lost(std::uint32_t pair);

  /// For a pair of so many pieces; half as many at most.
  std::size_t spares(std::size_t pieces, double round_trip_s) const;

 private:
  struct Trip {
    std::size_t pieces = 0, came = 0, lost = 0;
  };
  void settle(std::map<std::uint32_t, Trip>::iterator trip);

  std::map<std::uint32_t, Trip> trips_;  // of which not all is known
  std::deque<double> lost_shares_;       // of the last pairs
};

}  // namespace foresight
