// The `foresight` program: one subcommand per job.
//
// Exit codes: 0 done, 1 the machine cannot do it, 2 wrong input, 130 stopped by Ctrl-C, SIGTERM or SIGHUP. The last
// line on stderr names what is wrong, where, and the cure.
#include "apps/command_line/output_guard.hpp"
#include "apps/command_line/process.hpp"
#include "apps/commands.hpp"

int main(int argc, char** argv) {
  foresight::settle_process();
  return foresight::exit_code_of([&] {
    std::function<int()> action;
    const auto define = [&action](foresight::Command& app) {
      app.require_subcommand();
      foresight::add_commands(app, action);
    };
    const foresight::CommandLine line = foresight::read_command_line(
        argc, argv, "Foresight: a teleoperation display that already shows what the robot will do", FORESIGHT_VERSION,
        define);
    if (line.ended) return *line.ended;
    const foresight::OutputGuard guard(line.paths);
    return action();
  });
}
