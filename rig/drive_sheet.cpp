#include "rig/drive_sheet.hpp"

#include <fmt/core.h>

#include <array>
#include <numbers>

#include "common/error.hpp"
#include "drivers/canopen/cia402.hpp"
#include "drivers/canopen/eds_reader.hpp"

namespace foresight {
namespace {

using canopen::mode_bit;
using canopen::OperationMode;

/// Numbers of one file.
class Sheet {
 public:
  explicit Sheet(const std::filesystem::path& file) : file_(file), objects_(canopen::read_eds(file, 1)) {}

  bool has(std::uint16_t index, std::uint8_t sub = 0) const { return objects_.find(index, sub) != nullptr; }
  std::optional<std::int64_t> number(std::uint16_t index, std::uint8_t sub = 0) const {
    const canopen::ObjectEntry* const entry = objects_.find(index, sub);
    if (entry == nullptr) return std::nullopt;
    if (entry->configured_value && entry->configured_value->number) return entry->configured_value->number;
    return entry->default_value ? entry->default_value->number : std::nullopt;
  }
  /// Sub-index 1 over sub-index 2 (1 where it is not told); nothing where 1 is not told or either is not positive.
  std::optional<double> ratio(std::uint16_t index) const {
    const auto over = number(index, 1);
    const auto under = has(index, 2) ? number(index, 2).value_or(1) : 1;
    if (!over || *over <= 0 || under <= 0) return std::nullopt;
    return static_cast<double>(*over) / static_cast<double>(under);
  }
  std::optional<std::uint32_t> identity(std::uint8_t sub) const {
    const auto value = number(0x1018, sub);
    if (!value || *value == 0) return std::nullopt;
    return static_cast<std::uint32_t>(*value);
  }
  [[noreturn]] void refuse(const std::string& what, const std::string& cure) const {
    throw InputError(file_.string(), what, cure);
  }

 private:
  const std::filesystem::path& file_;
  canopen::ObjectDictionary objects_;
};

void require_drivable(const Sheet& sheet) {
  if (const auto type = sheet.number(0x1000); type && (*type & 0xffff) != 402 && *type != 0)
    sheet.refuse(fmt::format("is of profile {} (1000h is 0x{:X})", *type & 0xffff, *type),
                 "give the file of a drive of profile 402");
  const auto modes = sheet.number(0x6502);
  if (modes && *modes != 0 && (*modes & mode_bit(OperationMode::cyclic_position)) == 0)
    sheet.refuse(fmt::format("the drive has no cyclic synchronous position mode (6502h is 0x{:X})", *modes),
                 "ask its maker for a firmware that has; without --eds the rig is one for mock drives only");
  constexpr std::array<std::pair<std::uint16_t, const char*>, 3> watchdogs{
      {{0x1016, "consumer heartbeat"}, {0x1017, "producer heartbeat"}, {0x6007, "abort connection option"}}};
  for (const auto& [index, name] : watchdogs)
    if (!sheet.has(index) && !sheet.has(index, 1))
      sheet.refuse(fmt::format("the drive has no {} ({:X}h): it would go on when its master falls silent", name, index),
                   "choose a drive that has it; foresight robot enables no other");
}

// CiA 402-2, 7: with a feed constant, positions are in units of it per turn of the shaft; else in increments of the
// encoder, whose gear lies between.
void read_scaling(const Sheet& sheet, DriveSheet& out) {
  const auto resolution = sheet.ratio(0x608F), gear = sheet.ratio(0x6091), feed = sheet.ratio(0x6092);
  if (feed && *feed > 1) {
    out.counts_per_turn = feed;
    out.scaling = fmt::format("6092h: {:g} units a turn of the shaft", *feed);
  } else if (resolution && *resolution > 1) {
    out.counts_per_turn = *resolution * gear.value_or(1);
    out.scaling = fmt::format("608Fh {:g} a turn of the motor x 6091h gear {:g}", *resolution, gear.value_or(1));
    if (!gear) out.scaling += " (not told: is there none?)";
  }
  if (const auto rpm = sheet.number(0x6080); rpm && *rpm > 0)
    out.fastest_rad_per_s = static_cast<double>(*rpm) / 60 * 2 * std::numbers::pi / gear.value_or(1);
}

void read_homing(const Sheet& sheet, DriveSheet& out) {
  const auto modes = sheet.number(0x6502);
  out.can_home = !modes || *modes == 0 || (*modes & mode_bit(OperationMode::homing)) != 0;
  for (std::int64_t sub = 1, count = sheet.number(0x60E3).value_or(0); sub <= count && sub < 255; ++sub)
    if (const auto method = sheet.number(0x60E3, static_cast<std::uint8_t>(sub)))
      out.homing_methods.push_back(static_cast<int>(*method));
  if (const auto method = sheet.number(0x6098); method && *method != 0) out.homing_method = static_cast<int>(*method);
}

void read_gaps(const Sheet& sheet, DriveSheet& out) {
  struct Wanted {
    std::uint16_t index;
    std::uint8_t sub;
    const char* name;
  };
  constexpr std::array<Wanted, 8> all{{{0x605A, 0, "quick stop option"},
                                       {0x607D, 1, "position limits"},
                                       {0x607F, 0, "largest profile velocity"},
                                       {0x6083, 0, "profile acceleration"},
                                       {0x6085, 0, "quick stop deceleration"},
                                       {0x606C, 0, "actual velocity"},
                                       {0x60C2, 1, "interpolation period"},
                                       {0x60E3, 0, "list of homing methods"}}};
  for (const Wanted& wanted : all)
    if (!sheet.has(wanted.index, wanted.sub))
      out.lacks.push_back(fmt::format("{:04X}:{:02X} {}", wanted.index, wanted.sub, wanted.name));
}

}  // namespace

DriveSheet read_drive_sheet(const std::filesystem::path& file) {
  const Sheet sheet(file);
  require_drivable(sheet);
  DriveSheet out;
  out.file = file;
  out.vendor = sheet.identity(1);
  out.product = sheet.identity(2);
  read_scaling(sheet, out);
  read_homing(sheet, out);
  read_gaps(sheet, out);
  return out;
}

}  // namespace foresight
