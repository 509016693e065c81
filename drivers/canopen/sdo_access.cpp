#include "drivers/canopen/sdo_access.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "common/error.hpp"
#include "drivers/canopen/object_dictionary.hpp"
#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

std::string in_hex(std::uint64_t value) {
  return fmt::format("0x{:X}", value);
}

std::uint64_t cut(std::int64_t value, int bytes) {
  return static_cast<std::uint64_t>(value) & (bytes >= 8 ? ~std::uint64_t{0} : (std::uint64_t{1} << (8 * bytes)) - 1);
}

}  // namespace

SdoAccess::SdoAccess(SdoClient& client, CanBus& bus, Clock& clock, Pump pump, std::string device)
    : client_(client), bus_(bus), clock_(clock), pump_(std::move(pump)), device_(std::move(device)) {}

SdoStatus SdoAccess::run(ObjectRef object, const std::int64_t* value) {
  constexpr int kTries = 2;
  for (int i = 0; i < kTries; ++i) {
    if (value) {
      std::array<std::uint8_t, 8> bytes{};
      store(bytes, static_cast<std::uint64_t>(*value));
      client_.download(object.index, object.sub, {bytes.data(), object.bytes}, bus_, clock_.now());
    } else {
      client_.upload(object.index, object.sub, bus_, clock_.now());
    }
    while (client_.busy()) {
      pump_(client_.deadline());
      client_.check(bus_, clock_.now());
    }
    if (client_.status() != SdoStatus::timed_out) break;
  }
  return client_.status();
}

void SdoAccess::fail(const char* operation, ObjectRef object) const {
  const std::string what = device_ + ": " + operation + " object " + object_name(object.index, object.sub);
  switch (client_.status()) {
    case SdoStatus::timed_out:
      throw RuntimeFailure(what + " got no answer", "check power, wiring, bit rate and node id");
    case SdoStatus::aborted:
      throw RuntimeFailure(
          what + " was aborted with " + in_hex(client_.abort_code()) + " (" + abort_name(client_.abort_code()) + ")",
          "check that the device supports it");
    default:
      throw RuntimeFailure(what + " broke the SDO protocol (" + abort_name(client_.abort_code()) + ")",
                           "check that no other master talks to the device");
  }
}

std::int64_t SdoAccess::value(ObjectRef object) const {
  const auto data = client_.data();
  if (data.size() < object.bytes)
    throw RuntimeFailure(device_ + ": object " + object_name(object.index, object.sub) + " has " +
                             std::to_string(data.size()) + " bytes instead of " + std::to_string(object.bytes),
                         "check the device's profile");
  const std::uint64_t raw = load(data, object.bytes);
  return object.is_signed ? sign_extended(raw, 8 * object.bytes) : static_cast<std::int64_t>(raw);
}

std::int64_t SdoAccess::read(ObjectRef object) {
  if (run(object, nullptr) != SdoStatus::done) fail("reading", object);
  return value(object);
}

std::optional<std::int64_t> SdoAccess::read_if_there(ObjectRef object) {
  const SdoStatus status = run(object, nullptr);
  if (status == SdoStatus::aborted && means_absent(client_.abort_code())) return std::nullopt;
  if (status != SdoStatus::done) fail("reading", object);
  return value(object);
}

void SdoAccess::write(ObjectRef object, std::int64_t value) {
  if (run(object, &value) != SdoStatus::done) fail("writing", object);
}

void SdoAccess::expect(ObjectRef object, std::int64_t value, std::uint64_t mask) {
  const std::uint64_t kept = cut(read(object), object.bytes) & mask, wanted = cut(value, object.bytes) & mask;
  if (kept != wanted)
    throw InputError(device_,
                     "object " + object_name(object.index, object.sub) + " reads " + in_hex(kept) + " after " +
                         in_hex(wanted) + " was written",
                     "give a value that the device accepts");
}

void SdoAccess::write_proven(ObjectRef object, std::int64_t value) {
  write(object, value);
  expect(object, value);
}

Written SdoAccess::try_write(ObjectRef object, std::int64_t wanted) {
  SdoStatus status = run(object, &wanted);
  if (status == SdoStatus::done) status = run(object, nullptr);
  if (status == SdoStatus::aborted) return means_absent(client_.abort_code()) ? Written::absent : Written::refused;
  if (status != SdoStatus::done) fail("writing", object);
  return cut(value(object), object.bytes) == cut(wanted, object.bytes) ? Written::proven : Written::differs;
}

bool SdoAccess::wait(Duration timeout, const std::function<bool()>& done) {
  const RobotTime until = clock_.now() + timeout;
  while (!done()) {
    if (clock_.now() >= until) return false;
    pump_(until);
  }
  return true;
}

}  // namespace foresight::canopen
