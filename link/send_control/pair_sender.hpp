// The robot's end of the line: when to hand over the next pair, how large it may be, and its pieces until they arrived.
//
// The age of the newest picture is the way, the time in the line's queue, its own transmission, and what passes until
// the next one. So the queue is kept short, and a pair takes no more of the line than a fraction of a second:
//
//   hand over when    nothing has to be waited for, or what is on its way will have crossed in kHead of line time and
//                     what the road itself holds, or a part of that where it is long; and bytes without
//                     acknowledgement <= bytes acknowledged within the last 200 ms, or half again the road's round trip
//                     if that is longer
//   bytes             what the line may be trusted to carry (RateMeter) in a part of a tenth of a second: little is on
//                     its way when the line gets slower, and what is lost of quality comes back with the next pairs.
//                     Where the road is long, every picture is old, and who looks at predictions has more of fewer and
//                     sharper ones (decision 49): then in a tenth of a second and a bit
//   spare pieces      as many as pay (Redundancy): what is lost of a pair does not cost it a round trip
//
// Pure logic; one thread.
#pragma once

#include <algorithm>
#include <map>

#include "link/coding/coded_pair.hpp"
#include "link/coding/pair_coder.hpp"
#include "link/send_control/redundancy.hpp"
#include "link/send_control/transmissions.hpp"

namespace foresight {

class PairSender {
 public:
  struct Options {
    double first_bytes_per_s = 100'000;   ///< until the line was measured
    double shortest_s = 0.025;            ///< of line time for a pair
    double shortest_far_s = 0.010;        ///< on a long road, where what is on the way waits for long when it must
    double longest_s = 0.060;             ///< where the line is so thin that pictures would suffer
    double longest_far_s = 0.120;         ///< likewise on a long road
    std::size_t fine_bytes = 9'000;       ///< what a pair needs to look well; takes up to longest_s
    std::size_t fine_far_bytes = 20'000;  ///< what makes it a good texture; takes up to longest_far_s
    std::size_t least_bytes = 1'000;      ///< however thin the line; one packet, though pairs take a sixth more
    std::size_t most_bytes = 40'000;      ///< more shows little but the sensor's noise
    int most_on_the_way = static_cast<int>(kMostLanes);  ///< pairs, while packets get lost
  };

  PairSender() : PairSender(Options{}) {}
  explicit PairSender(const Options& options) : options_(options) {}

  /// Whether the newest picture should be encoded and handed over now.
  bool wants_pair(RobotTime now) const;
  /// What it is to be like.
  PairWish wish(RobotTime now) const;
  /// Takes the pair that was encoded for `wish(now)`; its pieces are sent next. While pieces of it are missing and of
  /// use, they are sent again.
  void hand_over(const CodedPair& pair, RobotTime now);

  /// Takes any bytes; of what is no acknowledgement nothing happens. What it says about pairs goes to `fates`.
  void take(std::span<const std::uint8_t> packet, RobotTime now, PairFates& fates);
  /// Packets to send now. Tells `fates` which pairs are given up.
  std::vector<Packet> packets(RobotTime now, PairFates& fates);
  /// When `packets` may have something without anything else happening.
  std::optional<RobotTime> due() const { return transmissions_.due(); }

  const Transmissions& transmissions() const { return transmissions_; }
  double bytes_per_s(RobotTime now) const;  ///< that the line is taken to carry
  /// The same, nothing as long as nothing had to wait for the line: then it carries more than it was ever given.
  std::optional<double> known_bytes_per_s(RobotTime now) const;

 private:
  bool waits() const;
  double road_s() const;  // there and back
  bool is_far() const;
  struct Pending {
    std::span<const std::uint8_t> piece(std::uint16_t index) const;
    bool is_whole() const { return arrived >= own; }
    std::size_t needed() const { return own - std::min(own, arrived + on_the_way); }  // besides those on the way

    enum class Is : std::uint8_t { here, on_the_way, arrived };
    std::uint32_t reference = 0;
    RobotTime handed_over;
    std::vector<std::uint8_t> bytes, spares;
    std::size_t own = 0;  // pieces; any as many of `pieces` make the pair
    std::vector<Is> pieces;
    std::size_t arrived = 0, on_the_way = 0;
  };
  void send_piece(std::uint32_t pair, std::uint16_t index, RobotTime now, std::vector<Packet>& out);
  void send_again(std::uint32_t number, const Pending& pending, RobotTime now, std::vector<Packet>& out);
  void give_up(std::uint32_t pair, PairFates& fates);
  bool worth_sending(const Pending& pending, RobotTime now) const;
  int pairs_on_the_way() const;

  Options options_;
  Transmissions transmissions_;
  Redundancy redundancy_;
  std::map<std::uint32_t, Pending> pending_;
  std::vector<std::pair<std::uint32_t, std::uint16_t>> fresh_;  // pieces never sent
  std::uint32_t last_number_ = 0, last_undecodable_ = 0;
};

}  // namespace foresight
