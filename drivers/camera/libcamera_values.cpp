#include "drivers/camera/libcamera_values.hpp"

#include <libcamera/formats.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight::libcam {
namespace {

namespace lc = libcamera;

constexpr const char* kMilli = "_milli";

constexpr struct {
  PixelFormat ours;
  const lc::PixelFormat* theirs;
} kFormats[] = {{PixelFormat::yuyv, &lc::formats::YUYV},
                {PixelFormat::nv12, &lc::formats::NV12},
                {PixelFormat::mjpeg, &lc::formats::MJPEG},
                {PixelFormat::grey, &lc::formats::R8}};

/// As the whole number that we show; nothing for lists, rectangles and text.
std::optional<std::int64_t> number(const lc::ControlValue& value) {
  if (value.isArray()) return std::nullopt;
  switch (value.type()) {
    case lc::ControlTypeBool: return value.get<bool>() ? 1 : 0;
    case lc::ControlTypeByte: return value.get<std::uint8_t>();
    case lc::ControlTypeInteger32: return value.get<std::int32_t>();
    case lc::ControlTypeInteger64: return value.get<std::int64_t>();
    case lc::ControlTypeFloat: return std::llround(1000.0 * value.get<float>());
    default: return std::nullopt;
  }
}

lc::ControlValue value_of(lc::ControlType type, std::int64_t number) {
  lc::ControlValue out;
  switch (type) {
    case lc::ControlTypeBool: out.set(number != 0); break;
    case lc::ControlTypeByte: out.set(static_cast<std::uint8_t>(number)); break;
    case lc::ControlTypeInteger32: out.set(static_cast<std::int32_t>(number)); break;
    case lc::ControlTypeFloat: out.set(static_cast<float>(number) / 1000); break;
    default: out.set(number);
  }
  return out;
}

}  // namespace

lc::PixelFormat offered_format(const lc::StreamFormats& offered, PixelFormat format, const std::string& where) {
  const auto theirs = offered.pixelformats();
  std::vector<std::string> ours;
  for (const auto& row : kFormats) {
    if (std::ranges::find(theirs, *row.theirs) == theirs.end()) continue;
    if (row.ours == format) return *row.theirs;
    ours.emplace_back(to_string(row.ours));
  }
  throw InputError(where, std::string("it has no format ") + to_string(format),
                   "choose one that it has: " + (ours.empty() ? "none that we know" : joined(ours)));
}

std::string plain_name(const lc::ControlId& id) {
  std::string out;
  for (const char c : id.name()) {
    const bool upper = c >= 'A' && c <= 'Z';
    if (upper && !out.empty()) out += '_';
    out += upper ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return id.type() == lc::ControlTypeFloat ? out + kMilli : out;
}

std::vector<CameraControl> list_controls(const lc::ControlInfoMap& known,
                                         const std::map<std::string, std::int64_t>& set) {
  std::vector<CameraControl> out;
  for (const auto& [id, info] : known) {
    const auto least = number(info.min()), most = number(info.max());
    if (!least || !most) continue;
    const std::string name = plain_name(*id);
    const auto found = set.find(name);
    out.push_back({name, *least, *most, 1, found != set.end() ? found->second : number(info.def()).value_or(*least)});
  }
  std::ranges::sort(out, {}, &CameraControl::name);
  return out;
}

void add_control(lc::ControlList& list, const lc::ControlInfoMap& known, const std::string& control, std::int64_t value,
                 const std::string& where) {
  std::vector<std::string> names;
  for (const auto& [id, info] : known) {
    const auto least = number(info.min()), most = number(info.max());
    if (!least || !most) continue;
    names.push_back(plain_name(*id));
    if (names.back() != control) continue;
    if (value < *least || value > *most)
      throw InputError(where, control + " = " + std::to_string(value),
                       "give " + std::to_string(*least) + " to " + std::to_string(*most));
    list.set(id->id(), value_of(id->type(), value));
    return;
  }
  throw InputError(where, "it has no control " + in_quotes(control), did_you_mean(control, names, "leave it out"));
}

}  // namespace foresight::libcam
