// How an emulated drive looks for home: the methods of CiA 402-2 (IEC 61800-7-201), object 6098h.
//
// A method is one edge of one switch, crossed slowly in one direction; the index pulse of the encoder, where it counts,
// is the next one in the same direction.
//
//                 negative                    home switch                    positive
//                 limit switch     3,4: from here on   5,6: up to here      limit switch
//     1, 17  ->  =======|  >
//     3, 19  ->                       <  |=================================
//     4, 20  ->                          |  >
//     5, 21  ->  ==============================|  >
//     6, 22  ->                             <  |
//     7 .. 10, 11 .. 14  (23 .. 30)    < |=====| <     > |=====| >     a switch that is closed over a part of the way
//     2, 18  ->                                                          <  |=======
//     33, 34     the next index pulse in negative or positive direction; 35, 37: here
//
// Pure logic, one thread. Positions in joint units of the shaft.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace foresight::sim {

struct NodeConfig;

/// Bits of the digital inputs 60FDh.
inline constexpr unsigned kNegativeLimit = 1, kPositiveLimit = 2, kHomeSwitch = 4;

/// What a method of 1 .. 14, 17 .. 30, 33 and 34 looks for.
struct HomingMethod {
  enum class Edge : std::uint8_t { none, lower, upper };  ///< of the way over which the switch is closed
  unsigned input = 0;                                     ///< its bit; 0: only the index pulse
  Edge edge = Edge::none;
  int way = 1;           ///< +1 or -1: how the edge is crossed, and where the index pulse lies from there
  int first = 0;         ///< 7 .. 14: where to begin while it is not known on which side of the switch the shaft is
  bool endless = false;  ///< 3 .. 6: the switch stays closed to the end of the way
  bool index = false;
};
/// Nothing for numbers that need no search (35, 37) and for those that mean nothing (0, 15, 16, 31, 32, ...).
std::optional<HomingMethod> homing_method(int number);

/// All numbers that emulated drives serve, 35 and 37 included; what 60E3h lists.
const std::vector<int>& served_homing_methods();

/// Puts limit switches a little beyond the ends of the range (config.min_position .. max_position), and the switch that
/// `number` looks for so that home is at `home`; index pulses lie at home and at equal distances from it.
void place_homing_switches(NodeConfig& config, int number, double home);

/// One search. To be asked at every step.
class HomingSearch {
 public:
  HomingSearch(const HomingMethod& method, double index_distance, double index_at);

  enum class Speed : std::int8_t { fast_back = -2, slow_back = -1, stand = 0, slow_on = 1, fast_on = 2 };
  /// Where to go now. `inputs`: the bits above, of a shaft at `shaft`.
  Speed step(double shaft, unsigned inputs);
  /// Where home is, once it is found; then step() says stand.
  std::optional<double> home() const { return home_; }
  /// It ran into a limit switch, and home was not before it; then step() says stand.
  bool failed() const { return phase_ == Phase::failed; }

 private:
  enum class Phase : std::uint8_t { approach, seek, cross, index, found, failed };
  enum class Side : std::uint8_t { unknown, below, inside, above };
  void see_side(double shaft, unsigned inputs);
  Side before() const;
  Side after() const;
  Speed move(int direction, bool fast, unsigned inputs);
  Speed seek(unsigned inputs);
  bool passed_index(double shaft);

  HomingMethod method_;
  double index_distance_, index_at_;
  Phase phase_ = Phase::approach;
  Side side_ = Side::unknown;
  std::optional<double> last_, home_;
};

}  // namespace foresight::sim
