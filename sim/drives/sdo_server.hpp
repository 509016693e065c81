// The SDO server of an emulated node: expedited and segmented transfers (CiA 301, section 7.2.4).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "drivers/can/can_frame.hpp"

namespace foresight::sim {

/// Abort codes of CiA 301, table 22.
enum class SdoAbort : std::uint32_t {
  none = 0,
  toggle_bit = 0x05030000,
  timed_out = 0x05040000,
  unknown_command = 0x05040001,
  out_of_memory = 0x05040005,
  unsupported_access = 0x06010000,
  write_only = 0x06010001,
  read_only = 0x06010002,
  no_such_object = 0x06020000,
  not_mappable = 0x06040041,
  pdo_too_long = 0x06040042,
  wrong_length = 0x06070010,
  too_long = 0x06070012,
  too_short = 0x06070013,
  no_such_sub_index = 0x06090011,
  value_range = 0x06090030,
  value_too_high = 0x06090031,
  value_too_low = 0x06090032,
  device_state = 0x08000022,
};

/// One transfer at a time; a new request ends an unfinished one. No block transfers. One thread.
class SdoServer {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Access {
    std::function<SdoAbort(std::uint32_t key, Bytes& value)> read;
    /// `exact`: the client told the length; else the value may have bytes too many, to be cut off.
    std::function<SdoAbort(std::uint32_t key, const Bytes& value, bool exact)> write;
  };
  explicit SdoServer(Access access) : access_(std::move(access)) {}

  /// The 8 bytes of a request to those of an answer; none where the client aborted.
  std::optional<std::array<std::uint8_t, 8>> answer(std::span<const std::uint8_t> request, RobotTime now);
  /// An abort, where a segmented transfer has stood still for a second.
  std::optional<std::array<std::uint8_t, 8>> expire(RobotTime now);
  void reset() { phase_ = Phase::idle; }

 private:
  using Answer = std::array<std::uint8_t, 8>;
  enum class Phase : std::uint8_t { idle, download, upload };
  Answer abort(std::uint32_t key, SdoAbort code);
  Answer initiate_download(std::span<const std::uint8_t> request);
  Answer download_segment(std::span<const std::uint8_t> request);
  Answer initiate_upload(std::span<const std::uint8_t> request);
  Answer upload_segment(std::span<const std::uint8_t> request);

  Access access_;
  Phase phase_ = Phase::idle;
  std::uint32_t key_ = 0;
  Bytes value_;
  std::size_t sent_ = 0, announced_ = 0;
  bool toggle_ = false;
  RobotTime last_;
};

}  // namespace foresight::sim
