#include "apps/link_command.hpp"

#include <memory>

#include "apps/link_jobs.hpp"

namespace foresight {

void add_link_place(Command& command, LinkPlace& place) {
  command.add_option("--domain", place.domain, "DDS domain, in place of the rig's (default 0)")->check(from_to(0, 230));
  command.add_option("--interface", place.interface, "Network interface, in place of the rig's (default lo)");
  command.add_option("--keys", place.keys, "Folder of `link keys`, in place of the rig's")->reads();
  command.add_option("--peer", place.peers, "Address or name of another host; again for more");
}

namespace {

void add_place(Command& command, LinkPlace& place) {
  command.add_option("--rig", place.rig, "Rig file: its `link:` section says where")->reads();
  add_link_place(command, place);
  command.add_option("--line", place.line, "File of a line (docs/line.md) that everything passes, out and in")->reads();
}

void add_status(Command& link, std::function<int()>& action) {
  auto* command = link.add_subcommand("status", "Who is there, which topics, and what is wrong with this host");
  auto options = std::make_shared<LinkStatusOptions>();
  add_place(*command, options->place);
  command->add_option("--seconds", options->seconds, "How long it listens")
      ->check(from_to(0.5, 60))
      ->capture_default_str();
  command->footer(
      "Where a robot is there, its clock and its pictures are looked at, too, as an operator's program does; a robot "
      "that\n"
      "codes for a thin line sends its pictures to one program at a time.\n\n"
      "Exit code: 0 where a robot is there, 1 where none is.\n\nExample: foresight link status --rig rig.yaml");
  command->callback([options, &action] { action = [options] { return link_status(*options); }; });
}

void add_listen(Command& link, std::function<int()>& action) {
  auto* command = link.add_subcommand("listen", "Prints a topic's messages, checked");
  auto options = std::make_shared<LinkListenOptions>();
  command->add_option("TOPIC", options->topic, "Such as joint_states, /tf or rt/foresight/robot_state")->required();
  add_place(*command, options->place);
  command->add_option("--count", options->count, "Stop after so many messages")->check(from_to(1, 1e15));
  command->add_option("--seconds", options->seconds, "Stop after so long")->check(from_to(0, 1e9));
  command->footer("Exit code: 1 where nothing came, or something came that is no such message.");
  command->callback([options, &action] { action = [options] { return link_listen(*options); }; });
}

void add_rate(Command& link, std::function<int()>& action) {
  auto* command = link.add_subcommand("rate", "Measures a topic: messages and bytes per second, age, losses");
  auto options = std::make_shared<LinkRateOptions>();
  command->add_option("TOPIC", options->topic, "As of `listen`")->required();
  add_place(*command, options->place);
  command->add_option("--seconds", options->seconds, "How long")->check(from_to(0.5, 1e9))->capture_default_str();
  command->footer(
      "The age is from a message's stamp until it was here, by the clocks of both hosts: it says what it seems to "
      "only\n"
      "where these agree.\n\n"
      "Exit code: 1 where nothing came.");
  command->callback([options, &action] { action = [options] { return link_rate(*options); }; });
}

void add_keys(Command& link, std::function<int()>& action) {
  auto* command = link.add_subcommand("keys", "Makes an authority, and keys for robot, operator and observer");
  auto options = std::make_shared<LinkKeysOptions>();
  command->add_option("DIR", options->folder, "A new folder")
      ->writes([](const std::filesystem::path& folder) -> std::vector<Output> {
        return {new_output(folder, Output::Kind::folder)};
      })
      ->required();
  command->add_option("--days", options->days, "How long they count")->check(from_to(1, 36500))->capture_default_str();
  command->footer(
      "Copy DIR/robot to the robot's host, DIR/operator to the operator's, DIR/observer to those who look on, each "
      "into a\n"
      "folder that `link.security` of the rig there names; keep DIR/authority to yourself.");
  command->callback([options, &action] { action = [options] { return link_keys(*options); }; });
}

}  // namespace

void add_link_command(Command& app, std::function<int()>& action) {
  auto* link = app.add_subcommand("link", "Looks at a running line: who is there, rates, ages, losses; makes its keys");
  link->require_subcommand();
  add_status(*link, action);
  add_listen(*link, action);
  add_rate(*link, action);
  add_keys(*link, action);
}

}  // namespace foresight
