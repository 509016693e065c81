// Objects of one node as numbers, waiting for the answers: for set-up only.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "common/clock.hpp"
#include "drivers/canopen/sdo.hpp"

namespace foresight::canopen {

/// An integer object and its size on the wire.
struct ObjectRef {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bytes = 4;  ///< 1 .. 8
  bool is_signed = false;
};

enum class Written : std::uint8_t { proven, absent, differs, refused };

/// Blocks up to twice the client's timeout a call: one repetition, since a node may be busy with its
/// flash. Throws RuntimeFailure naming device, object, operation and the reason. One thread, in set-up.
class SdoAccess {
 public:
  /// Waits for frames until the given time at most, and hands them to whom they belong.
  using Pump = std::function<void(RobotTime until)>;
  SdoAccess(SdoClient& client, CanBus& bus, Clock& clock, Pump pump, std::string device);

  std::int64_t read(ObjectRef object);
  std::optional<std::int64_t> read_if_there(ObjectRef object);  ///< nothing where the node lacks it
  void write(ObjectRef object, std::int64_t value);
  /// Reads the object; throws InputError where (it & mask) != (value & mask).
  void expect(ObjectRef object, std::int64_t value, std::uint64_t mask = ~std::uint64_t{0});
  void write_proven(ObjectRef object, std::int64_t value);  ///< write() and expect()
  /// Writes and reads back; tells instead of throwing what the node made of it. Silence throws.
  Written try_write(ObjectRef object, std::int64_t value);
  /// Until `done()` holds; false after `timeout`.
  bool wait(Duration timeout, const std::function<bool()>& done);

  const std::string& device() const { return device_; }  ///< "arm_1 (node 3 on can0)"

 private:
  SdoStatus run(ObjectRef object, const std::int64_t* value);
  [[noreturn]] void fail(const char* operation, ObjectRef object) const;
  std::int64_t value(ObjectRef object) const;

  SdoClient& client_;
  CanBus& bus_;
  Clock& clock_;
  Pump pump_;
  std::string device_;
};

}  // namespace foresight::canopen
