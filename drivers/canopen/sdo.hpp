// The client of the service data object protocol (CiA 301, 7.2.4): reads and writes objects of one
// node, expedited and segmented. No block transfer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "drivers/can/can_bus.hpp"
#include "drivers/canopen/abort_code.hpp"

namespace foresight::canopen {

enum class SdoStatus : std::uint8_t {
  idle,
  busy,
  done,
  aborted,    ///< by the node; abort_code() says why
  timed_out,  ///< the node did not answer; it was told so
  failed,     ///< the node broke the protocol or sent too much; abort_code() is what it was told
};

/// Pure: takes frames and the time, puts frames on the bus, never waits. One transfer at a time. Default
/// connection (600h and 580h + node). Allocates in the constructor only. One thread.
class SdoClient {
 public:
  /// `timeout`: longest wait for each answer. `capacity`: the longest object in bytes.
  explicit SdoClient(int node, Duration timeout, std::size_t capacity = 1024);

  /// Ends a running transfer without telling the node. False (and `failed`) where `data` exceeds the
  /// capacity; data of up to four bytes goes expedited.
  void upload(std::uint16_t index, std::uint8_t sub, CanBus& bus, RobotTime now) noexcept;
  bool download(std::uint16_t index, std::uint8_t sub, std::span<const std::uint8_t> data, CanBus& bus,
                RobotTime now) noexcept;
  /// Takes any frame; those that are not an answer to the running transfer change nothing: other identifiers,
  /// sizes other than 8, answers for another object (a late one, of a transfer given up before).
  void receive(const CanFrame& frame, CanBus& bus, RobotTime now) noexcept;
  /// Gives a transfer up whose answer is late.
  void check(CanBus& bus, RobotTime now) noexcept;

  SdoStatus status() const noexcept { return status_; }
  bool busy() const noexcept { return status_ == SdoStatus::busy; }
  RobotTime deadline() const noexcept { return deadline_; }  ///< of the awaited answer, while busy
  std::uint32_t abort_code() const noexcept { return abort_code_; }
  /// What was read, after `done`. Where an expedited answer does not state its size, all four bytes.
  std::span<const std::uint8_t> data() const noexcept { return {buffer_.data(), count_}; }
  int node() const noexcept { return node_; }

 private:
  enum class Step : std::uint8_t { upload_start, upload_segment, download_start, download_segment };
  void begin(std::uint16_t index, std::uint8_t sub, Step step) noexcept;
  void send(const CanFrame& frame, CanBus& bus, RobotTime now) noexcept;
  CanFrame request(std::uint8_t command) const noexcept;
  void give_up(SdoStatus status, std::uint32_t code, CanBus& bus) noexcept;
  void upload_started(const CanFrame& answer, CanBus& bus, RobotTime now) noexcept;
  void upload_segment(const CanFrame& answer, CanBus& bus, RobotTime now) noexcept;
  void ask_segment(CanBus& bus, RobotTime now) noexcept;
  void send_segment(CanBus& bus, RobotTime now) noexcept;

  int node_;
  Duration timeout_;
  std::vector<std::uint8_t> buffer_;
  std::size_t count_ = 0;      // bytes in the buffer
  std::size_t sent_ = 0;       // of them, in a segmented download
  std::size_t announced_ = 0;  // size that the node announced; 0: none
  SdoStatus status_ = SdoStatus::idle;
  Step step_ = Step::upload_start;
  std::uint16_t index_ = 0;
  std::uint8_t sub_ = 0;
  bool toggle_ = false;
  std::uint32_t abort_code_ = 0;
  RobotTime deadline_;
};

}  // namespace foresight::canopen
