#include "seat/seat_words.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "link/control/control_words.hpp"

namespace foresight {
namespace {

using Phase = ControlSeatStatus::Phase;

constexpr const char* kInCommand = "in command";

/// The robot's cures name the keys of its own terminal; those of the line name none.
std::string with_our_keys(std::string cure) {
  constexpr std::pair<std::string_view, const char*> kKeys[] = {
      {"(e)", "(E)"}, {"(h)", "(H)"}, {"(r)", "(X)"}, {"(c)", "(Z)"}, {"ask for control", "ask for control (G)"}};
  for (const auto& [theirs, ours] : kKeys)
    if (const std::size_t at = cure.find(theirs); at != cure.npos) cure.replace(at, theirs.size(), ours);
  return cure;
}

/// G asks, or takes the request back: who waits for control, and is told to ask for it, would lose his place by it.
std::string control_cure(const ControlSeatStatus& control) {
  if (!control.wanted || control.phase != Phase::connected) return with_our_keys(control.cure);
  return control.cure + (control.cure.empty() ? "" : "; ") + "G takes your request back";
}

constexpr Duration kOldWords = std::chrono::milliseconds(1500);  // the robot's words come every second

double ms(Duration d) {
  return 1e3 * to_seconds(d);
}

/// For how long nothing has come of a robot that was heard; nothing where it is heard.
std::optional<Duration> silence(const SeatStatus& status) {
  const auto& control = status.control.state_age;
  if (control && *control > ControlSeatStatus::kSilentAfter) return control;
  if (status.robot_age && *status.robot_age > kOldWords) return status.robot_age;
  return std::nullopt;
}

/// Why nothing that the robot says of itself is taken: it is another one, and it is heard.
const Difference* refusal(const SeatStatus& status) {
  const auto& control = status.control.state_age;
  if (!control || *control > ControlSeatStatus::kSilentAfter) return nullptr;
  const auto found = std::ranges::find_if(status.control.differences, &Difference::refuses);
  return found == status.control.differences.end() ? nullptr : &*found;
}

SeatLine line_words(const SeatStatus& status) {
  SeatLine out{"line", "", ""};
  if (const auto silent = silence(status); silent && !refusal(status))
    return {"line", fmt::format("nothing comes of the robot for {:.1f} s", to_seconds(*silent)),
            "see that its program runs, and that the line is up", Urgency::trouble};
  if (!status.line.clock) return {"line", "no clock of the robot yet", "wait for a round trip", Urgency::note};
  out.words = status.delay.valid ? fmt::format("commands act after {:.0f} ± {:.0f} ms", 1e3 * status.delay.seconds,
                                               2e3 * status.delay.sigma)
                                 : "it is not known yet when commands act";
  if (status.line.round_trip) out.words += fmt::format(", round trip {:.0f} ms", ms(*status.line.round_trip));
  if (!status.line.ages.empty() && status.line.pairs_per_s > 0)
    out.words += fmt::format(", newest image {:.0f} ms old when it came", ms(status.line.ages.back().delay));
  return out;
}

/// Who has asked the joints to look for home is not told to.
std::string fault_words(std::string fault, const SeatStatus& status) {
  constexpr std::string_view kCure = "home them (H)";
  const std::size_t at = fault.find(kCure);
  if (at != fault.npos && status.robot && status.robot->phase.label == "homing")
    fault.replace(at, kCure.size(), "they look for home");
  return fault;
}

SeatLine images_words(const SeatStatus& status, const std::string& fault) {
  if (!fault.empty()) return {"images", fault_words(fault, status), "", Urgency::trouble};
  return {"images",
          fmt::format("{} pairs, {:.1f}/s, {}", static_cast<unsigned long long>(status.line.pairs.pairs),
                      status.line.pairs_per_s, status.line.coding),
          ""};
}

SeatLine robot_words(const SeatStatus& status) {
  const auto silent = silence(status);
  if (const Difference* other = refusal(status); other && (silent || !status.robot))
    return {"robot", "it is another one, and what it says of itself is not taken", other->cure, Urgency::trouble};
  if (!status.robot) {
    const bool looks = status.control.phase == Phase::connecting;
    return {"robot", "nothing is heard of it", looks ? status.control.cure : "wait for the line", Urgency::trouble};
  }
  if (silent)
    return {"robot", fmt::format("silent for {:.1f} s", to_seconds(*silent)), "wait for the line", Urgency::trouble};
  const link::RobotState& robot = *status.robot;
  const bool commands = status.control.phase == Phase::holding;  // else nobody here can do what a cure says
  SeatLine out{"robot", robot.doing.name, commands ? with_our_keys(robot.doing.cure) : ""};
  if (!robot.hold.empty()) out.words += "; " + robot.hold;
  if (!robot.refused.empty()) out.words += "; refused: " + robot.refused;
  if (!robot.bus_healthy) out.words += "; bus: " + robot.bus_reason;
  out.urgency = !robot.bus_healthy || robot.phase.label == "stopped" ? Urgency::trouble
                : robot.hold.empty()                                 ? Urgency::fine
                                                                     : Urgency::note;
  return out;
}

SeatLine drives_words(const SeatStatus& status) {
  SeatLine out{"drives", "", ""};
  if (!status.robot) return out;
  std::size_t fine = 0;
  struct Trouble {
    std::string drives, words;
  };
  std::vector<Trouble> troubles;
  for (const link::DriveLine& drive : status.robot->drives) {
    const bool good = drive.fault.empty() && drive.known;
    fine += good ? 1 : 0;
    if (good) continue;
    std::string words = drive.fault.empty() ? drive.state + (drive.homed ? "" : ", not homed") : drive.fault;
    if (const auto same = std::ranges::find(troubles, words, &Trouble::words); same != troubles.end())
      same->drives += ", " + drive.name;
    else
      troubles.push_back({drive.name, std::move(words)});
    out.urgency = drive.fault.empty() ? std::max(out.urgency, Urgency::note) : Urgency::trouble;
  }
  for (const auto& [drives, words] : troubles) out.words += (out.words.empty() ? "" : "; ") + drives + ": " + words;
  if (out.words.empty()) out.words = fmt::format("all {} answer", fine);
  if (const auto silent = silence(status)) {
    out.words = fmt::format("not known for {:.1f} s; before: {}", to_seconds(*silent), out.words);
    out.urgency = std::max(out.urgency, Urgency::note);
  }
  return out;
}

SeatLine commander_words(const SeatStatus& status) {
  const ControlState& state = status.robot_control;
  SeatLine out{kInCommand, "", control_cure(status.control)};
  switch (status.control.phase) {
    case Phase::connecting: return {kInCommand, status.control.words, out.cure, Urgency::note};
    case Phase::connected:
      out.words = status.control.words;
      if (!state.holder_name.empty() && out.words.find(state.holder_name) == std::string::npos)
        out.words += "; " + state.holder_name + " commands";
      out.urgency = Urgency::note;
      return out;
    case Phase::holding: break;
  }
  out.words = status.control.follows ? "you; the robot follows" : "you";
  if (!status.control.words.empty()) out.words += "; " + status.control.words;
  if (!state.asking_name.empty()) out.words += "; " + state.asking_name + " asks for it: T hands it over";
  if (!state.ready) out.cure.clear();  // the switch would be in vain: the robot's line says what it needs
  if (status.held && !status.engaged) {
    out.urgency = Urgency::trouble;
    out.cure = "let go of the switch, and press it again";
  }
  return out;
}

/// Of the newest request, until another one is made: a key that does nothing must not do so silently.
SeatLine request_words(const SeatStatus& status) {
  SeatLine out{"asked", "", ""};
  if (status.fates.empty() || status.fates.back().outcome == RequestOutcome::taken) return out;
  const RequestFate& fate = status.fates.back();
  if (fate.outcome == RequestOutcome::not_holder && status.control.phase == Phase::holding) return out;  // he is now
  const ControlWords words = fate.outcome ? words_for(*fate.outcome)
                                          : ControlWords{"no answer came", "look at the robot's state, and ask again"};
  out.words = fmt::format("{}: {}", to_string(fate.what), words.name);
  const bool waits =
      status.control.wanted && status.control.phase != Phase::holding && fate.outcome == RequestOutcome::not_holder;
  const auto refused = std::ranges::find_if(status.control.differences, &Difference::refuses);
  if (refused != status.control.differences.end())
    out.cure = refused->cure;
  else
    out.cure = waits ? "wait until control is granted to you" : with_our_keys(words.cure);
  out.urgency = Urgency::note;
  return out;
}

/// mrad or mm: no more digits than say something of where a joint is.
std::string error_words(double error) {
  constexpr double kFinest = 0.1;
  return fmt::format("{:.{}f}", std::max(error, kFinest), error < 10 ? 1 : 0);
}

SeatLine prediction_words(const SeatStatus& status, std::span<const std::string> names) {
  const PredictedRobot& shown = status.shown;
  if (shown.status == StateStatus::invalid)
    return {"prediction", to_words(shown, names), "the delayed image is what counts", Urgency::trouble};
  SeatLine out{"prediction", "", ""};
  if (status.outlook.error)
    out.words = "95 % of joints within " + error_words(1e3 * *status.outlook.error) + " mrad or mm";
  else
    out.words = "nothing to compare with yet";
  if (shown.blocked) {
    out.words += "; parts would come too close";
    out.urgency = Urgency::note;
  }
  return out;
}

}  // namespace

const char* mark(Urgency urgency) {
  switch (urgency) {
    case Urgency::fine: return "  ";
    case Urgency::note: return "- ";
    case Urgency::trouble: return "! ";
  }
  return "";
}

std::vector<SeatLine> seat_lines(const SeatStatus& status, std::span<const std::string> names,
                                 const std::string& fault) {
  std::vector<SeatLine> out{commander_words(status), robot_words(status),         request_words(status),
                            line_words(status),      images_words(status, fault), prediction_words(status, names),
                            drives_words(status)};
  for (const Difference& difference : status.control.differences)
    if (status.control.words.find(difference.words) == std::string::npos)  // else who commands says it
      out.push_back({difference.refuses ? "refused" : "differs", difference.words, difference.cure,
                     difference.refuses ? Urgency::trouble : Urgency::note});
  std::erase_if(out, [](const SeatLine& line) { return line.words.empty(); });
  return out;
}

void leave_out_fine(std::vector<SeatLine>& lines) {
  std::erase_if(lines, [](const SeatLine& line) { return line.urgency == Urgency::fine && line.label != kInCommand; });
}

SeatLine next_step(const SeatStatus& status) {
  if (status.control.phase != Phase::holding)
    return {"next", status.control.words, control_cure(status.control), Urgency::note};
  if (silence(status))
    return {"next", "nothing is heard of the robot", status.held ? "let go of the switch" : "wait for the line",
            Urgency::trouble};
  const bool refused = status.refused && status.robot_control.ready;  // else it would be in vain to press again
  if ((status.held && !status.engaged) || refused)
    return {"next", "the switch does not count", "let go, and press again", Urgency::trouble};
  if (status.engaged)
    return {"next", status.control.follows ? "driving" : "waiting for the robot to follow", "", Urgency::fine};
  const link::RobotState* robot = status.robot ? &*status.robot : nullptr;
  if (robot && !robot->doing.cure.empty() && !status.robot_control.ready)
    return {"next", robot->doing.name, with_our_keys(robot->doing.cure), Urgency::note};
  if (status.robot_control.ready)
    return {"next", "ready", "hold the switch and move, or Enter with it to begin", Urgency::fine};
  return {"next", status.control.words, status.control.cure, Urgency::note};
}

}  // namespace foresight
