// Which lane (pair_coder.hpp) each pair goes into, and what it builds on there.
#pragma once

#include <array>

#include "link/coding/pair_coder.hpp"

namespace foresight {

/// A plain value; one thread.
class EncoderLanes {
 public:
  struct Place {
    std::size_t lane = 0;         ///< below kMostLanes
    std::uint32_t reference = 0;  ///< the pair that it builds on; 0: the lane begins anew
  };
  /// The lane of the newest pair that may be built on, else one that has to begin anyway, else that of the newest that
  /// is on its way.
  Place place(const PairWish& wish) const;
  /// This pair is the lane's newest now.
  void coded(std::size_t lane, std::uint32_t number);
  void arrived(std::uint32_t number);  ///< as of PairEncoder
  void gone(std::uint32_t number);     ///< as of PairEncoder
  void begin_anew();                   ///< as of PairEncoder

 private:
  struct Lane {
    std::uint32_t number = 0;  // of the last pair
    bool arrived = false;      // the receiver has it
    bool broken = true;        // has to begin anew
  };
  std::array<Lane, kMostLanes> lanes_;
};

}  // namespace foresight
