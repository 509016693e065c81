// The `foresight` program: one subcommand per job.
//
// Exit codes: 0 done, 1 the machine cannot do it, 2 wrong input, 130 stopped by Ctrl-C. The last
// line on stderr names what is wrong, where, and the cure.
#include <iostream>
#include <new>

#include "apps/commands.hpp"
#include "common/error.hpp"

int main(int argc, char** argv) {
  std::function<int()> action;
  const auto define = [&action](foresight::Command& app) {
    app.require_subcommand();
    foresight::add_commands(app, action);
  };
  const auto ended = foresight::read_command_line(
      argc, argv, "Foresight: a teleoperation display that already shows what the robot will do", FORESIGHT_VERSION,
      define);
  if (ended) return *ended;
  try {
    return action();
  } catch (const foresight::InputError& error) {
    std::cerr << "foresight: " << error.what() << "\n";
    return 2;
  } catch (const std::bad_alloc&) {
    std::cerr << "foresight: out of memory; close other programs, or give a smaller run or model\n";
    return 1;
  } catch (const std::exception& error) {
    std::cerr << "foresight: " << error.what() << "\n";
    return 1;
  }
}
