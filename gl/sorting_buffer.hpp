// Draws in an order with fewer changes of state, without waiting for all that there is to draw.
//
//   draws, each with its state  -->  [ a buffer of so many ]  -->  draws; those of one state come together
//
// Sorting all draws takes them all to be known, and gives up their order; a buffer takes them as they come, from a
// scene that moves and is culled. Whenever it is full, all draws of one state leave it, and those of that state that
// come next pass at once. Which state leaves, is the strategy: none is always best, as the best order is a travelling
// salesman's. (Raecke, Sohler, Westermann: "Online Scheduling for Sorting Buffers", ESA 2002.)
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <random>
#include <vector>

namespace foresight::gl {

enum class SortingStrategy : std::uint8_t {
  round_robin,          ///< that of the slot whose turn it is: as good as any, and simplest
  random_choice,        ///< that of any slot
  least_recently_used,  ///< that which has not come for longest
  bounded_waste         ///< that which has taken most room, summed over changes
};

struct Draw {
  int state = 0, item = 0;
  bool operator==(const Draw&) const = default;
};

/// One thread.
class SortingBuffer {
 public:
  /// `slots`: draws that it holds; 0: they pass as they come. `seed`: of random_choice.
  SortingBuffer(std::size_t slots, SortingStrategy strategy, unsigned seed = 1);

  /// Takes a draw; those that leave are appended to `out`.
  void put(const Draw& draw, std::vector<Draw>& out);
  /// All that is left leaves.
  void flush(std::vector<Draw>& out);

 private:
  int choose();
  void leave(int state, std::vector<Draw>& out);

  std::size_t slots_;
  SortingStrategy strategy_;
  std::mt19937 random_;
  std::vector<Draw> held_;  // in the order in which they came
  std::size_t turn_ = 0;
  std::uint64_t puts_ = 0;
  bool any_left_ = false;
  int current_ = 0;                     // state of what left last
  std::map<int, std::uint64_t> last_;   // put of each state
  std::map<int, std::uint64_t> waste_;  // slots that each state held at changes, summed
};

/// How often the state changes along them, the first draw included.
std::size_t state_changes(const std::vector<Draw>& draws);

}  // namespace foresight::gl
