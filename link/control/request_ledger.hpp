// Requests that are executed once, however often they come.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "link/control/messages.hpp"

namespace foresight {

/// Emergency stops, which an operator repeats over one connection after the other until he hears of it. One thread;
/// does not allocate.
class StopLedger {
 public:
  /// False: this one was noted before, whoever brought it. Two operators' have the same number, but were not made at
  /// the same nanosecond of two clocks.
  bool note_new(const Request& stop);

 private:
  static constexpr std::size_t kKept = 64;
  struct Entry {
    std::uint64_t id = 0;
    OperatorTime given;
    bool operator==(const Entry&) const = default;
  };
  std::array<Entry, kKept> entries_{};
  std::size_t next_ = 0;
};

/// Of one operator's connection. One thread; does not allocate.
class RequestLedger {
 public:
  /// What was answered to this one before; nothing where it is new. One that a later one overtook is not new, unless it
  /// is an emergency stop.
  std::optional<RequestOutcome> answered(const Request& request) const;
  void note(std::uint64_t id, RequestOutcome outcome);

 private:
  static constexpr std::size_t kKept = 32;
  struct Entry {
    std::uint64_t id = 0;
    RequestOutcome outcome = RequestOutcome::taken;
  };
  std::array<Entry, kKept> entries_{};
  std::size_t next_ = 0;
  std::uint64_t newest_ = 0;
};

}  // namespace foresight
