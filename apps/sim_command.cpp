#include "apps/sim_command.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <sstream>
#include <thread>

#include "apps/sim_rack.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "drivers/can/socket_can_bus.hpp"
#include "rig/robot_devices.hpp"
#include "sim/drives/drive_rack.hpp"
#include "sim/drives/rack_presets.hpp"

namespace foresight {
namespace {

struct SimArguments {
  std::string can, rack, rig, profile = "powercube";
};

std::vector<sim::NodeConfig> nodes_of(const SimArguments& arguments) {
  if (!arguments.rack.empty()) return read_rack(arguments.rack);
  if (!arguments.rig.empty()) {
    const Rig rig = read_rig(arguments.rig);
    for (std::size_t i = 0; i < rig.buses.size(); ++i)
      if (rig.buses[i].interface == arguments.can) return emulated_drives(rig, i);
    throw InputError(arguments.rig, "no bus of this rig is on " + in_quotes(arguments.can),
                     "give its interface with --can");
  }
  return arguments.profile == "cia402" ? sim::cia402_rack() : sim::powercube_rack();
}

std::vector<std::string> names_of(const sim::DriveRack& rack) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < rack.size(); ++i) out.push_back(rack.config(i).name);
  return out;
}

// Positions, velocities and accelerations in the joint's unit; the four last ones since the start or the last "forget".
void show(const sim::DriveRack& rack) {
  std::printf("%-16s %4s %10s %10s %6s %10s %10s %10s %10s\n", "drive", "node", "position", "velocity", "brake",
              "lowest", "highest", "fastest", "hardest");
  for (std::size_t i = 0; i < rack.size(); ++i) {
    const sim::ShaftState shaft = rack.shaft(i);
    std::printf("%-16s %4d %10.5f %10.5f %6s %10.5f %10.5f %10.5f %10.4f\n", rack.config(i).name.c_str(),
                rack.config(i).node, shaft.position, shaft.velocity, shaft.brake_closed ? "closed" : "open",
                shaft.most_negative, shaft.most_positive, shaft.largest_velocity, shaft.largest_acceleration);
  }
  std::printf("\n");  // ends the table, for programs that read it
  std::fflush(stdout);
}

// "show", "forget", "quit" or "FAULT DRIVE [VALUE]". Returns false to end.
bool obey(const std::string& line, sim::DriveRack& rack) {
  std::istringstream words(line);
  std::string verb, name, value = "0";
  words >> verb >> name >> value;
  if (verb == "quit") return false;
  if (verb == "show") show(rack);
  if (verb == "forget")
    for (std::size_t i = 0; i < rack.size(); ++i) rack.forget_extremes(i);
  if (verb.empty() || verb == "show" || verb == "forget") return true;
  std::vector<std::string> verbs{"show", "forget", "quit"};
  for (int f = 0; f <= static_cast<int>(sim::DriveFault::no_power); ++f) {
    const auto fault = static_cast<sim::DriveFault>(f);
    verbs.emplace_back(sim::to_string(fault));
    if (verb != verbs.back()) continue;
    const auto drive = rack.find(name);
    const auto number = parse_number(value);
    if (drive && number)
      rack.inject(*drive, fault, *number);
    else if (!drive)
      std::fprintf(stderr, "sim: there is no drive %s; %s\n", in_quotes(name).c_str(),
                   did_you_mean(name, names_of(rack)).c_str());
    else
      std::fprintf(stderr, "sim: %s is not a number\n", in_quotes(value).c_str());
    return true;
  }
  std::fprintf(stderr, "sim: there is no command %s; %s\n", in_quotes(verb).c_str(), did_you_mean(verb, verbs).c_str());
  return true;
}

// Waits for lines on stdin, or, once that is closed, for Ctrl-C alone.
void obey_stdin(sim::DriveRack& rack) {
  std::string text;
  bool open = true;
  while (!stop_requested()) {
    pollfd in{open ? STDIN_FILENO : -1, POLLIN, 0};
    if (poll(&in, 1, 100) <= 0) continue;
    char buffer[256];
    const ssize_t got = read(STDIN_FILENO, buffer, sizeof buffer);
    if (got <= 0)
      open = false;
    else
      text.append(buffer, static_cast<std::size_t>(got));
    for (std::size_t end; (end = text.find('\n')) != std::string::npos; text.erase(0, end + 1))
      if (!obey(text.substr(0, end), rack)) return;
  }
}

int run(const SimArguments& arguments) {
  const std::vector<sim::NodeConfig> nodes = nodes_of(arguments);
  MonotonicClock clock;
  sim::DriveRack rack(clock, std::make_unique<SocketCanBus>(arguments.can), nodes);
  poll_stop_signals();
  std::printf("sim: %zu drives on %s; commands: show, forget, quit, FAULT DRIVE [VALUE]\n", rack.size(),
              arguments.can.c_str());
  std::fflush(stdout);
  const std::jthread thread([&](std::stop_token stop) { rack.run(stop); });
  obey_stdin(rack);
  return stop_requested() ? kStopped : 0;
}

}  // namespace

void add_sim_command(Command& app, std::function<int()>& action) {
  Command* const sim = app.add_subcommand("sim", "Emulated hardware");
  sim->require_subcommand();
  Command* const command = sim->add_subcommand("drives", "Emulated drives on a CAN interface, for any master");
  const auto arguments = std::make_shared<SimArguments>();
  command->add_option("--can", arguments->can, "CAN interface, such as can0 or vcan0")->required();
  const Option* const rack =
      command->add_option("--rack", arguments->rack, "YAML file with a list of drives, instead of the built-in ones")
          ->reads()
          ->check(existing_file());
  command->add_option("--rig", arguments->rig, "Rig file: the drives that it has on this interface")
      ->reads()
      ->check(existing_file())
      ->excludes(rack);
  command
      ->add_option("--profile", arguments->profile,
                   "Built-in drives: powercube (ids 1 to 9) or cia402 (nodes 3 to 11): an arm of seven and a pan-tilt")
      ->check(one_of({"powercube", "cia402"}))
      ->capture_default_str();
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace foresight
