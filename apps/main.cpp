// The `foresight` program: one subcommand per job.
//
// Exit codes: 0 done, 1 the machine cannot do it, 2 wrong input, 130 stopped by Ctrl-C. The last
// line on stderr names what is wrong, where, and the cure.
#include <CLI/CLI.hpp>
#include <iostream>

#include "apps/bench/bench_command.hpp"
#include "apps/calibrate/calibrate_command.hpp"
#include "apps/can_command.hpp"
#include "apps/doctor_command.hpp"
#include "apps/export_command.hpp"
#include "apps/record_command.hpp"
#include "apps/replay_command.hpp"
#include "apps/robot_command.hpp"
#include "apps/sim_command.hpp"
#include "apps/synth_command.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace {

// What is wrong with the command line, and what to do about it.
std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  std::vector<std::string> jobs;
  for (const CLI::App* job : app.get_subcommands({})) jobs.push_back(job->get_name());
  const auto chosen = app.get_subcommands();
  const auto unknown = app.remaining();
  if (chosen.empty() && !unknown.empty() && !unknown.front().starts_with('-'))
    return "there is no subcommand " + foresight::in_quotes(unknown.front()) + "; did you mean '" +
           foresight::nearest_word(unknown.front(), jobs) + "'? See `foresight --help`";
  return error.what() + ("; see `foresight " + (chosen.empty() ? "" : chosen.front()->get_name() + " ")) + "--help`";
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Foresight: a teleoperation display that already shows what the robot will do"};
  app.set_version_flag("--version", FORESIGHT_VERSION);
  app.require_subcommand(1);
  std::function<int()> action;
  foresight::add_replay_command(app, action);
  foresight::add_record_command(app, action);
  foresight::add_export_command(app, action);
  foresight::add_synth_command(app, action);
  foresight::add_can_command(app, action);
  foresight::add_sim_command(app, action);
  foresight::add_bench_command(app, action);
  foresight::add_robot_command(app, action);
  foresight::add_doctor_command(app, action);
  foresight::add_calibrate_command(app, action);

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success)) return app.exit(error);
    std::cerr << "foresight: " << explain(app, error) << "\n";
    return 2;
  }
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
