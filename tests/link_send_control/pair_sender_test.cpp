#include "link/send_control/pair_sender.hpp"

namespace foresight::pair_sender_test {
namespace {

using std::chrono::milliseconds;

class NoFates final : public PairFates {
 public:
  void arrived(std::uint32_t) override {}
  void gone(std::uint32_t) override {}
};

/// A sender of ten pairs a second, which other traffic leaves little of the line; its receiver tells of each packet.
class Sender {
 public:
  explicit Sender(double first_bytes_per_s = 2'000) : sender_({.first_bytes_per_s = first_bytes_per_s}) {}

  /// So many pairs, each there and back in `trip`.
  void send(int pairs, Duration trip) {
    for (int i = 0; i < pairs; ++i) {
      wait(1);
      CodedPair pair{.number = ++number_, .coding = Coding::h264, .width = 1, .height = 1};
      pair.data.resize(500);
      sender_.hand_over(pair, now_);
      for (const Packet& packet : sender_.packets(now_, fates_))
        if (const auto piece = parse_packet(packet); const auto* what = std::get_if<Piece>(&piece))
          on_the_way_.push_back({what->sequence, now_ + trip});
    }
  }
  /// So many tenths of a second.
  void wait(int count) {
    for (int i = 0; i < count; ++i) {
      now_ = now_ + milliseconds(100);
      hear();
    }
  }
  double bytes_per_s() const { return sender_.bytes_per_s(now_); }
  /// Of the line's time, for the next pair.
  double wished_s() const { return static_cast<double>(sender_.wish(now_).bytes) / bytes_per_s(); }
  double given_per_s() const {
    return static_cast<double>(sender_.transmissions().acknowledged_within(Transmissions::kRecent, now_)) /
           to_seconds(Transmissions::kRecent);
  }
  Duration mean_trip() const { return *sender_.transmissions().round_trip(); }

 private:
  struct Way {
    std::uint32_t sequence;
    RobotTime told;
  };
  void hear() {
    for (; !on_the_way_.empty() && on_the_way_.front().told <= now_; on_the_way_.erase(on_the_way_.begin())) {
      const Way& way = on_the_way_.front();
      Acknowledgement out;
      out.newest = way.sequence;
      out.before.set();
      out.arrivals = {{way.sequence, Duration{way.told.ns}}};
      sender_.take(to_packet(out), way.told, fates_);
    }
  }
  PairSender sender_;
  NoFates fates_;
  RobotTime now_{1'000'000'000};
  std::uint32_t number_ = 0;
  std::vector<Way> on_the_way_;
};

// After an outage pairs are small, and tell of themselves ten times a second: their mean trip stays long for seconds.
TEST(PairSender, GivesMoreOnceNothingWaitsWhateverTheMeanRemembers) {
  Sender sender;
  sender.send(30, milliseconds(500));
  sender.send(10, milliseconds(4500));
  sender.wait(45);
  sender.send(10, milliseconds(500));
  EXPECT_GT(sender.given_per_s(), 3'000);
  ASSERT_GT(sender.mean_trip(), milliseconds(600)) << "it would have been found out anyhow: the test shows nothing";
  EXPECT_GE(sender.bytes_per_s(), 2 * sender.given_per_s());
}

// What is far away is old in any case: sharper pairs make better textures than more of them.
TEST(PairSender, FarAwayPairsAreFewerAndLarger) {
  Sender near(80'000), far(80'000);
  near.send(10, milliseconds(40));
  near.wait(5);
  far.send(10, milliseconds(500));
  far.wait(10);
  ASSERT_LT(near.bytes_per_s(), 120'000) << "a pair would not take the longest time";
  EXPECT_NEAR(near.wished_s(), 0.06, 1e-3);
  EXPECT_NEAR(far.wished_s(), 0.12, 1e-3);
}

}  // namespace
}  // namespace foresight::pair_sender_test
