#include "drivers/powercube/link.hpp"

#include <algorithm>

#include "common/error.hpp"

namespace foresight::powercube {
namespace {

using namespace std::chrono_literals;

constexpr int kAttempts = 3;
constexpr Duration kAnswerTime = 100ms;
constexpr Duration kFeedTime = 30ms;

}  // namespace

void Link::send(const CanFrame& frame, const std::string& who) {
  const CanSend result = bus_.send(frame);
  if (result == CanSend::sent) return;
  throw RuntimeFailure(who + " on " + bus_.name() + ": cannot send \"" + describe(frame) + "\", " +
                           (result == CanSend::full ? "the transmit queue is full" : "the bus is down"),
                       "check cable, terminators and bit rate, and that the interface is up");
}

void Link::feed_watchdogs() {
  if (now() - fed_ < kFeedTime) return;
  bus_.send(broadcast(Command::watchdog_refresh));  // a refusal shows in the question that follows
  fed_ = now();
}

Message Link::receive(Duration timeout) {
  feed_watchdogs();
  const auto frame = bus_.receive(std::min(timeout, kFeedTime));
  return frame ? decode(*frame) : Message{};
}

double Link::get(int module, Param param, const std::string& who) {
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    send(get_param(module, param), who);
    const RobotTime until = now() + kAnswerTime;
    for (Duration left = kAnswerTime; left.count() > 0; left = until - now()) {
      const Message answer = receive(left);
      if (answer.module == module && answer.is(Message::Kind::value, param)) return answer.value;
    }
  }
  throw RuntimeFailure(who + " on " + bus_.name() + ": no answer to \"" + describe(get_param(module, param)) +
                           "\" in " + std::to_string(kAttempts) + " attempts of 100 ms",
                       "check its power, cable, bit rate and module id");
}

double Link::set(int module, Param param, double value, const std::string& who) {
  send(set_param(module, param, value), who);
  return get(module, param, who);
}

}  // namespace foresight::powercube
