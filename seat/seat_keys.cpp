#include "seat/seat_keys.hpp"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <algorithm>
#include <initializer_list>
#include <iterator>

namespace foresight {
namespace {

constexpr SeatKeyBinding kBindings[] = {
    {SeatKey::stop, GLFW_KEY_SPACE, "space"},
    {SeatKey::end, GLFW_KEY_Q, "Q"},
    {SeatKey::enable, GLFW_KEY_E, "E"},
    {SeatKey::home, GLFW_KEY_H, "H"},
    {SeatKey::reset, GLFW_KEY_X, "X"},
    {SeatKey::set_up, GLFW_KEY_Z, "Z"},
    {SeatKey::control, GLFW_KEY_G, "G"},
    {SeatKey::hand_over, GLFW_KEY_T, "T"},
    {SeatKey::main_view, GLFW_KEY_TAB, "Tab"},
    {SeatKey::stereo, GLFW_KEY_F2, "F2"},
    {SeatKey::swap_eyes, GLFW_KEY_F5, "F5"},
    {SeatKey::stereogram, GLFW_KEY_F6, "F6"},
    {SeatKey::stereogram_depth, GLFW_KEY_F7, "F7"},
    {SeatKey::stereogram_pattern, GLFW_KEY_F8, "F8"},
    {SeatKey::stereogram_variant, GLFW_KEY_F9, "F9"},
    {SeatKey::beside, GLFW_KEY_F3, "F3"},
    {SeatKey::paint, GLFW_KEY_F4, "F4"},
    {SeatKey::marks, GLFW_KEY_B, "B"},
    {SeatKey::help, GLFW_KEY_F1, "F1"},
    {SeatKey::sounds, GLFW_KEY_F10, "F10"},
    {SeatKey::screenshot, GLFW_KEY_P, "P"},
};

constexpr bool in_order() {
  for (std::size_t i = 0; i < std::size(kBindings); ++i)
    if (static_cast<std::size_t>(kBindings[i].key) != i) return false;
  return std::size(kBindings) == static_cast<std::size_t>(SeatKey::screenshot) + 1;
}
static_assert(in_order());

std::string all_of(std::initializer_list<SeatKey> keys) {
  std::string out;
  for (const SeatKey key : keys) out += (out.empty() ? "" : ", ") + std::string(printed(key));
  return out;
}

}  // namespace

std::span<const SeatKeyBinding> seat_keys() noexcept {
  return kBindings;
}

const char* printed(SeatKey key) noexcept {
  return kBindings[static_cast<std::size_t>(key)].printed;
}

std::optional<SeatKey> seat_key(int glfw_code) noexcept {
  const auto found = std::ranges::find(kBindings, glfw_code, &SeatKeyBinding::code);
  if (found == std::end(kBindings)) return std::nullopt;
  return found->key;
}

std::vector<std::pair<std::string, std::string>> key_words(
    const std::vector<std::pair<std::string, std::string>>& device, const DrivenParts& parts) {
  using enum SeatKey;
  std::vector<std::pair<std::string, std::string>> out = HandDriver::keys(parts);
  out.insert(out.begin(), {{all_of({stop}), "stop at once"},
                           {all_of({enable, home, reset, set_up}), "enable, home, reset, configure drives anew"}});
  out.insert(out.end(), device.begin(), device.end());
  out.insert(out.end(),
             {{all_of({control}), "give control back, or the request for it; ask for it again"},
              {all_of({hand_over}), "hand control over to who asks"},
              {all_of({main_view}), "prediction, newest image, both, split (drag its border)"},
              {all_of({stereo, swap_eyes}), "for two eyes: which way; swap the eyes"},
              {all_of({stereogram}) + "; " + all_of({stereogram_depth, stereogram_pattern, stereogram_variant}),
               "a stereogram; its depth, pattern, variant"},
              {all_of({beside}), "from beside: the mouse looks around"},
              {all_of({paint}), "wireframe, age, fineness, errors"},
              {all_of({marks}), "what is not exact, and was wrong"},
              {all_of({help, sounds}), "more keys, none, few words; sounds off, or on"},
              {all_of({screenshot, end}) + ", Esc", "screenshot; end, while no switch is held"}});
  return out;
}

}  // namespace foresight
