#include "seat/seat_log.hpp"

#include <algorithm>

namespace foresight {
namespace {

/// Lines of these labels are states rather than figures.
constexpr const char* kStates[] = {"next", "in command", "robot", "drives", "shown", "carries"};

bool is_state(const std::string& label) {
  return std::ranges::find(kStates, label) != std::end(kStates);
}

std::string without_figures(const SeatLine& line) {
  std::string out = line.words + "|" + line.cure;
  std::erase_if(out, [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  return out;
}

std::string text_of(const SeatLine& line) {
  return line.label + ": " + mark(line.urgency) + line.words + (line.cure.empty() ? "" : " -> " + line.cure);
}

}  // namespace

std::vector<std::string> SeatLog::news(std::span<const SeatLine> lines) {
  std::vector<std::string> out;
  for (auto& [which, told] : told_) told.now = false;
  for (const SeatLine& line : lines) {
    int nth = 0;
    while (told_[{line.label, nth}].now) ++nth;
    Told& told = told_[{line.label, nth}];
    told.now = true;
    const std::string words = without_figures(line);
    const bool state = is_state(line.label);
    const bool worse = line.urgency != Urgency::fine && words != told.words;
    const bool over = line.urgency == Urgency::fine && told.urgency != Urgency::fine;
    if (worse || over || (state && words != told.words)) out.push_back(text_of(line));
    told.words = words;
    told.text = line.words;
    told.urgency = line.urgency;
  }
  for (auto& [which, told] : told_) {
    if (told.now || told.words.empty() || (told.urgency == Urgency::fine && !is_state(which.first))) continue;
    out.push_back(which.first + ": no longer: " + told.text);
    told = {};
  }
  return out;
}

}  // namespace foresight
