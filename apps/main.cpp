// The `foresight` program: one subcommand per job.
//
// Exit codes: 0 done, 1 the machine cannot do it, 2 wrong input, 130 stopped by Ctrl-C. The last
// line on stderr names what is wrong, where, and the cure.
#include <CLI/CLI.hpp>
#include <iostream>

#include "apps/replay_command.hpp"
#include "apps/sample_command.hpp"
#include "common/error.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Foresight: a teleoperation display that already shows what the robot will do"};
  app.set_version_flag("--version", FORESIGHT_VERSION);
  app.require_subcommand(1);
  std::function<int()> action;
  foresight::add_replay_command(app, action);
  foresight::add_sample_command(app, action);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    std::cerr << "foresight: " << error.what() << "; see `foresight --help`\n";
    return 2;
  }
  try {
    return action();
  } catch (const foresight::InputError& error) {
    std::cerr << "foresight: " << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "foresight: " << error.what() << "\n";
    return 1;
  }
}
