// For a program that a test does not live in, FORESIGHT_TEST_XR says what happens, in words with blanks between:
//
//   no-opengl no-egl no-headset    the runtime is without       size=64x48    pixels of an eye
//   real-time                      xrWaitFrame sleeps           take-off@90   with the 90th frame
//   put-on@N open-menu@N lose-session@N lose-instance@N close@N squeeze@N let-go@N    likewise
//
// Each happens once, also where an instance follows that counts its frames anew.
// The head looks to and fro, and the right hand goes round.
#include <cmath>
#include <cstdlib>
#include <sstream>
#include <utility>

#include "tests/openxr_runtime/state.hpp"

namespace foresight::openxr_runtime {
namespace {

struct Script {
  std::multimap<std::uint64_t, std::string> events;
  bool squeezes = false;
};

Script& script() {
  static Script& one = *new Script;
  return one;
}

World swaying(double seconds) {
  World out;
  out.head = looking({0, 1.2f, 0}, 0.3 * std::sin(seconds), 0.1 * std::sin(0.7 * seconds));
  out.hands[0].on = false;
  auto& hand = out.hands[1];
  hand.pose.position = {0.2f + 0.05f * static_cast<float>(std::cos(seconds)),
                        1.0f + 0.05f * static_cast<float>(std::sin(seconds)), -0.4f};
  hand.squeeze = script().squeezes ? 1 : 0;
  return out;
}

void read_word(const std::string& word, Settings& settings) {
  if (const auto at = word.find('@'); at != std::string::npos)
    script().events.emplace(std::strtoull(word.c_str() + at + 1, nullptr, 10), word.substr(0, at));
  if (word == "no-opengl") settings.opengl = false;
  if (word == "no-egl") settings.egl = false;
  if (word == "no-headset") settings.headset = false;
  if (word == "real-time") settings.real_time = true;
  if (word.starts_with("size=")) {
    char* rest = nullptr;
    settings.width = static_cast<std::uint32_t>(std::strtoul(word.c_str() + 5, &rest, 10));
    if (*rest == 'x') settings.height = static_cast<std::uint32_t>(std::strtoul(rest + 1, nullptr, 10));
  }
}

}  // namespace

void read_script(Runtime::State& state) {
  static bool read = false;
  const char* const text = std::getenv("FORESIGHT_TEST_XR");
  if (!text || std::exchange(read, true)) return;
  state.now = 1'000'000'000;
  state.settings.world = swaying;
  std::istringstream words(text);
  for (std::string word; words >> word;) read_word(word, state.settings);
}

void follow_script(std::uint64_t frame) {
  const auto [first, last] = script().events.equal_range(frame);
  for (auto event = first; event != last; ++event) {
    const std::string& what = event->second;
    if (what == "take-off") runtime().take_off();
    if (what == "put-on") runtime().put_on();
    if (what == "open-menu") runtime().open_menu();
    if (what == "lose-session") runtime().lose_session();
    if (what == "lose-instance") runtime().lose_instance();
    if (what == "close") runtime().close_in_menu();
    if (what == "squeeze") script().squeezes = true;
    if (what == "let-go") script().squeezes = false;
  }
  script().events.erase(first, last);
}

}  // namespace foresight::openxr_runtime
