#include "apps/line_recording_command.hpp"

#include <memory>

#include "apps/line_recording.hpp"
#include "apps/link_command.hpp"
#include "session/run_recorder.hpp"

namespace foresight {
namespace {

void add_play(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("play", "Plays a recorded line as if it were the robot");
  auto options = std::make_shared<PlayOptions>();
  command->add_option("FILE", options->file, "Recording of `record --line` (MCAP)")->reads()->required();
  command->add_option("--rate", options->rate, "Times as fast")->check(from_to(0.1, 10))->capture_default_str();
  command->add_option("--from", options->from, "Begins so many seconds after the recording's begin")
      ->check(from_to(0, 1e7))
      ->capture_default_str();
  command->add_option("--rig", options->place.rig, "Rig file: its `link:` section says where")->reads();
  add_link_place(*command, options->place);
  command->footer(
      "Pictures, joints, transforms and states go out under their topics, all stamps moved to now by the same. What "
      "was\n"
      "said to a robot, who commanded, and set-points are not played: a recording moves nothing. It is refused where "
      "a\n"
      "robot's program is on the domain.\n\n"
      "Exit codes: 0 played to its end, 1 a robot came meanwhile, 2 wrong input, 130 Ctrl-C.\n\n"
      "Example: foresight play session.mcap --domain 7");
  command->callback([options, &action] { action = [options] { return play(*options); }; });
}

void add_export_run(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("export-run", "Makes a run of a recorded line, as `replay` takes it");
  auto options = std::make_shared<ExportRunOptions>();
  command->add_option("FILE", options->file, "Recording of `record --line` (MCAP)")->reads()->required();
  command->add_option("--out", options->out, "Folder to write; an earlier run in it is replaced")
      ->writes([](const std::filesystem::path& folder) -> std::vector<Output> {
        return {{folder, Output::Kind::replaced_folder, {}, [](const std::string& where, const auto& there) {
                   require_replaceable(where, there, RunRecorder::form());
                 }}};
      })
      ->required();
  command->add_option("--rig", options->rig, "Rig file, in place of the recorded one")->reads();
  command->add_option("--scene", options->scene, "Scene or mesh, in place of the rig's")->reads();
  command->add_flag("--mock", options->mock, "The robot's program ran with --mock, though the recording was not told");
  command->footer(
      "Exit codes: 0 done, 1 the disk is full, or a pair could not be written (what came before is kept), 2 wrong "
      "input.\n\n"
      "Example: foresight export-run session.mcap --out run && foresight replay run");
  command->callback([options, &action] { action = [options] { return export_run(*options); }; });
}

}  // namespace

void add_line_recording_commands(Command& app, std::function<int()>& action) {
  add_play(app, action);
  add_export_run(app, action);
}

}  // namespace foresight
