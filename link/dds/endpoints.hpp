// Writers and readers of topics.
#pragma once

#include <functional>
#include <span>

#include "common/time.hpp"
#include "link/dds/participant.hpp"
#include "link/messages/cdr.hpp"
#include "link/messages/checks.hpp"

namespace foresight::link {

/// One thread.
class Writer {
 public:
  /// Throws RuntimeFailure: another type on a topic of that name in this program. `participant` must outlive it.
  Writer(Participant& participant, const Topic& topic);
  ~Writer();
  Writer(const Writer&) = delete;

  /// False: it did not go (only of Delivery::each, where readers are too far behind). Never waits for a reader.
  bool write(Bytes cdr) noexcept;
  template <detail::Message T>
  bool write(const T& message) {
    return write(to_cdr(message));
  }
  std::size_t readers() const noexcept;  ///< that are matched, in any program

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// Why a message is refused that cannot be read at all.
inline constexpr const char* kNoMessage = "bytes are no such message";

/// A sample while it is visited.
struct Sample {
  std::span<const std::uint8_t> cdr;  ///< as anybody may have sent it
  std::int64_t sent_unix_ns = 0;      ///< when it was written, by the writer's wall clock
  std::uint64_t writer = 0;           ///< one number for each writer
};

/// One thread; counts from any. Its participant must outlive it.
class Reader {
 public:
  Reader(Participant& participant, const Topic& topic);  ///< as Writer
  ~Reader();

  /// Visits every sample that has come, oldest first, where it lies; returns how many there were.
  std::size_t take(const std::function<void(const Sample&)>& visit);
  /// Until a sample is there, `timeout` at most.
  bool wait(Duration timeout) const noexcept;
  /// From now on wait() also ends where a sample of `other` has come, whose participant is the same, and which must
  /// outlive this.
  void wait_also_for(const Reader& other);
  std::size_t writers() const noexcept;  ///< that are matched
  std::uint64_t lost() const noexcept;   ///< samples that were never seen here, of reliable writers too

  /// Decodes and checks each that has come; what is wrong is refused, not visited.
  template <detail::Message T>
  std::size_t take(const Expected& expected, const std::function<void(T&&, const Sample&)>& visit) {
    return take([&](const Sample& sample) {
      std::optional<T> message = from_cdr<T>(sample.cdr);
      const std::string wrong = message ? objection(*message, expected) : kNoMessage;
      wrong.empty() ? visit(std::move(*message), sample) : refuse(wrong);
    });
  }
  /// A message that was visited is none, or says what cannot be: the participant counts it, and tells why.
  void refuse(const std::string& why);

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::string topic_;
  bool waits_for_others_ = false;
};

}  // namespace foresight::link
