#include "apps/can_command.hpp"

#include <memory>

#include "apps/can_jobs.hpp"
#include "apps/run_options.hpp"

namespace foresight {
namespace {

void add_scan(Command& can, std::function<int()>& action) {
  auto* command = can.add_subcommand("scan", "Lists the CAN interfaces with their bit rate and state");
  command->footer("Exit code: 0 where an interface can be used, 1 where none is there or all are down or bus-off.");
  command->callback([&action] { action = [] { return scan_can(); }; });
}

void add_dump(Command& can, std::function<int()>& action) {
  auto* command = can.add_subcommand("dump", "Prints the frames on a bus, in can-utils' log form");
  auto options = std::make_shared<CanDumpOptions>();
  command->add_option("IF", options->interface, "Interface, such as can0")->required();
  command->add_option("--count", options->count, "Stop after so many frames")->check(from_to(1, 1e15));
  command->add_option("--seconds", options->seconds, "Stop after so long")->check(from_to(0, 1e9));
  command->add_option("--log", options->log, "Write a log there too")->writes(can_log_form());
  command->add_option("--filter", options->filters, "Only these identifiers: ID:MASK in hex (8 digits: 29 bits)");
  command->add_flag("--fd", options->fd, "FD frames too; the interface must be set up for them");
  command->footer("Example: foresight can dump can0 --filter 580:780 --seconds 10 --log sdo.log");
  command->callback([options, &action] { action = [options] { return dump_can(*options); }; });
}

void add_send(Command& can, std::function<int()>& action) {
  auto* command = can.add_subcommand("send", "Sends one frame");
  auto options = std::make_shared<CanSendOptions>();
  command->add_option("IF", options->interface, "Interface, such as can0")->required();
  command->add_option("FRAME", options->frame, "123#DEADBEEF; 123#R8 remote; 123##1AABB FD")->required();
  command->callback([options, &action] { action = [options] { return send_can(*options); }; });
}

void add_replay(Command& can, std::function<int()>& action) {
  auto* command = can.add_subcommand("replay", "Sends what a log holds, at its pace");
  auto options = std::make_shared<CanReplayOptions>();
  command->add_option("FILE", options->file, "A log of `foresight can dump --log` or candump -l")->reads()->required();
  command->add_option("IF", options->interface, "Interface, such as vcan0")->required();
  command->add_option("--speed", options->speed, "2: twice as fast")->check(from_to(1e-3, 1e6))->capture_default_str();
  command->add_option("--gap", options->gap_ms, "ms between frames that have no times")
      ->check(from_to(0, 1e6))
      ->capture_default_str();
  command->callback([options, &action] { action = [options] { return replay_can(*options); }; });
}

void add_explain(Command& can, std::function<int()>& action) {
  auto* command = can.add_subcommand("explain", "Prints a log's frames with what they say in words");
  auto options = std::make_shared<CanExplainOptions>();
  command->add_option("FILE", options->file, "A log of `foresight can dump --log`, `robot --log` or candump -l")
      ->reads()
      ->required();
  command->add_option("--protocol", options->protocol, "What the bus speaks: cia402, powercube or schunk-motion")
      ->check(one_of({"cia402", "powercube", "schunk-motion"}));
  command->add_option("--rig", options->rig, "Rig file: says what each bus speaks, and names the joints")->reads();
  command
      ->add_option("--eds", options->eds,
                   "EDS or DCF file of all nodes, or NODE=FILE of one: objects and PDOs by the names that it gives")
      ->reads();
  command->add_option("--node", options->node, "Only frames of and to this node")->check(from_to(1, 127));
  command->add_flag("--errors", options->errors,
                    "Only what went wrong: emergencies, faults, aborts, restarts, error frames, what is not known");
  command->add_option("--from", options->from, "Only from so many seconds after the first frame on")
      ->check(from_to(0, 1e9));
  command->add_option("--to", options->to, "Only until so many seconds after the first frame")->check(from_to(0, 1e9));
  command->add_flag("--absolute", options->absolute, "The log's own times, not those since its first frame");
  command->footer(
      "A summary comes first: time span, nodes, frames of each kind, errors. Process data are decoded as the log's "
      "own\n"
      "set-up maps them, or as --eds says.\n\n"
      "Example: foresight can explain session-arm.log --rig rig.yaml --node 3 --from 12 --to 13\n"
      "Exit code: 0 where all frames are known, 1 where some are not.");
  command->callback([options, &action] { action = [options] { return explain_can(*options); }; });
}

}  // namespace

void add_can_command(Command& app, std::function<int()>& action) {
  auto* can = app.add_subcommand("can", "Looks at CAN buses, records them, and talks to them by hand");
  can->require_subcommand();
  add_scan(*can, action);
  add_dump(*can, action);
  add_send(*can, action);
  add_replay(*can, action);
  add_explain(*can, action);
}

}  // namespace foresight
