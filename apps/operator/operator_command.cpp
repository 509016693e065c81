#include "apps/operator/operator_command.hpp"

#include <fmt/core.h>

#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/level_options.hpp"
#include "apps/operator/live_seat.hpp"
#include "apps/operator/seat_trial.hpp"
#include "apps/operator/served_trial.hpp"
#include "apps/run_options.hpp"
#include "apps/view_outputs.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/stop_signal.hpp"
#include "rig/home_check.hpp"
#include "rig/joint_groups.hpp"
#include "rig/rig.hpp"
#include "seat/panel_lens.hpp"
#include "seat/seat_textures.hpp"
#include "seat/tool_script.hpp"
#include "seat/tour.hpp"
#include "sim/pan_tilt_head.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

enum class Script { pick, tour };

struct Arguments {
  std::string rig, name = "operator", scene, device;
  HeadDisplayKind head_display = HeadDisplayKind::none;
  bool second_eye_of_first = false;
  std::vector<std::string> display_lenses;
  bool mock = false, physics = false, served = false;
  unsigned layout = 0;
  double rate_hz = 30, font_scale = 1, fidelity_db = TrustSwitchOptions{}.lowest_db;
  std::optional<Script> script;  // nothing: a seat with a window
  double delay_ms = 0;
  std::string line;
  std::optional<LinkCoding> coding;
  unsigned seed = 1;
  std::optional<double> seconds;
  double pictures_hz = 5;
  bool still_head = false, zero_delay = true, sounds = true;
  TextureOptions textures = kSeatTextures;
  LevelArguments detail;
  ViewOutputs outputs;
};

void say(const std::string& words) {
  std::fprintf(stderr, "operator: %s\n", words.c_str());
}

LineSpec line_of(const Arguments& arguments) {
  LineSpec out;
  if (!arguments.line.empty()) out = read_line_spec(arguments.line);
  const Duration delay = seconds(arguments.delay_ms * 1e-3);
  out.up.delay += delay;
  out.down.delay += delay;
  out.seed = arguments.seed;
  return out;
}

/// A tour goes on for ever; a pick ends when it is done, which bad lines make late.
double most_seconds(const Arguments& arguments) {
  constexpr double kTour = 30, kPick = 120;
  return arguments.seconds.value_or(arguments.script == Script::pick ? kPick : kTour);
}

/// Over a line that is written down, pairs are coded as they would be on it.
LinkCoding coding_of(const Rig& rig, const Arguments& arguments) {
  return arguments.coding.value_or(arguments.line.empty() ? rig.link.coding : LinkCoding::h264);
}

nlohmann::json number(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

nlohmann::ordered_json to_json(const std::vector<PictureTrust>& pictures) {
  auto out = nlohmann::ordered_json::array();
  for (const PictureTrust& picture : pictures)
    out.push_back({{"picture", picture.stem},
                   {"exact_share", number(picture.figures.exact_share)},
                   {"exact_wrong", number(picture.figures.exact_wrong)},
                   {"wrong_share", number(picture.figures.wrong_share)},
                   {"newest_instead", picture.newest_instead}});
  return out;
}

nlohmann::ordered_json report_of(const SeatTrialFigures& figures, const Arguments& arguments) {
  nlohmann::ordered_json out;
  const SeatFidelity& seen = figures.fidelity;
  out["predicted_db"] = number(seen.predicted_db);
  out["delayed_db"] = number(seen.delayed_db);
  out["zero_delay_db"] = number(seen.zero_delay_db);
  out["moving_predicted_db"] = number(seen.moving_predicted_db);
  out["moving_delayed_db"] = number(seen.moving_delayed_db);
  out["video_db"] = number(seen.video_db);
  out["moving_video_db"] = number(seen.moving_video_db);
  out["moving_share"] = number(seen.moving_share);
  out["succeeded"] = figures.task.succeeded;
  out["failure"] = figures.task.failure;
  out["seen_in_tray"] = figures.seen_in_tray ? nlohmann::json(*figures.seen_in_tray) : nlohmann::json();
  out["task_s"] = figures.task.seconds;
  out["held_share"] = figures.task.held_share;
  out["held_by"] = figures.task.held_by;
  out["delay_ms"] = arguments.delay_ms;
  if (!arguments.line.empty()) out["line"] = arguments.line;
  out["seed"] = arguments.seed;
  out["acts_after_ms"] = 1e3 * figures.delay_s;
  out["image_age_ms"] = seen.image_age_s ? nlohmann::json(1e3 * *seen.image_age_s) : nlohmann::json();
  out["coding"] = figures.line.coding;
  out["pairs"] = figures.line.pairs.pairs;
  out["joints_p95"] = figures.joints_p95;
  out["invalid_share"] = seen.invalid_share;
  out["losses"] = figures.losses;
  out["exact_share"] = number(seen.trust.exact_share);
  out["exact_wrong"] = number(seen.trust.exact_wrong);
  out["exact_wrong_any_channel"] = number(seen.trust.exact_wrong_any);
  out["wrong_share"] = number(seen.trust.wrong_share);
  out["unconfirmed_share"] = number(seen.trust.unconfirmed);
  out["fallback_share"] = number(seen.trust.fallback_share);
  out["trust"] = to_json(seen.trust_of_pictures);
  out["view"] = to_json(seen.record);
  return out;
}

void print(const SeatTrialFigures& f) {
  const auto db = [](const std::optional<double>& value) { return value ? fmt::format("{:.2f} dB", *value) : "-"; };
  const SeatFidelity& seen = f.fidelity;
  fmt::print("shown {}, delayed image {}, without a line {}\n", db(seen.predicted_db), db(seen.delayed_db),
             db(seen.zero_delay_db));
  if (seen.video_db) fmt::print("one eye as a video in the same bytes {}\n", db(seen.video_db));
  fmt::print("where something moved ({:.1f} % of what is seen): shown {}, delayed image {}\n",
             1e2 * seen.moving_share.value_or(0), db(seen.moving_predicted_db), db(seen.moving_delayed_db));
  fmt::print("joints shown within {:.2g} mrad or mm (95 %); commands act after {:.0f} ms; {:.1f} s, {}\n",
             1e3 * f.joints_p95, 1e3 * f.delay_s, f.task.seconds,
             f.task.succeeded ? "succeeded" : "failed: " + f.task.failure);
  if (f.task.held_share >= 0.01)
    fmt::print("the safety gate held the robot back for {:.0f} % of the time; at last: {}\n", 1e2 * f.task.held_share,
               f.task.held_by);
  if (seen.trust.exact_share) fmt::print("{}\n", to_sentence(seen.trust));
}

/// What the program shall do.
struct Task {
  bool picks = false;
  std::string thing, tray = "tray";
  unsigned layout = 0;
};

/// Seeds pick one brick or the other, from one arrangement or another.
Task task_of(const Arguments& arguments) {
  Task out;
  out.picks = arguments.script == Script::pick;
  out.thing = arguments.seed % 2 == 1 ? "brick_red" : "brick_blue";
  out.layout = arguments.served ? arguments.layout : arguments.seed - 1;
  return out;
}

SeatTrialFigures run_stepped(const Rig& rig, const Arguments& arguments, const Task& task,
                             std::shared_ptr<const LiveScene> scene, ScriptedMotion& motion) {
  SeatTrialOptions options;
  options.rig_file = arguments.rig;
  options.line = line_of(arguments);
  options.delay_s = arguments.delay_ms * 1e-3;
  if (task.picks) options.physics = arguments.seed;
  options.layout = task.layout;
  options.thing = task.thing;
  options.tray = task.tray;
  options.seed = arguments.seed;
  options.most_s = most_seconds(arguments);
  options.pictures_hz = arguments.pictures_hz;
  options.zero_delay = arguments.zero_delay;
  options.textures = arguments.textures;
  options.levels = level_settings(arguments.detail);
  options.fall_back.lowest_db = arguments.fidelity_db;
  options.out = arguments.outputs.out;
  return try_seat(
      rig, std::move(scene), options, motion, [] { return stop_requested(); }, say);
}

SeatTrialFigures run_served(const Rig& rig, const Arguments& arguments, const Task& task,
                            std::shared_ptr<const LiveScene> scene, ScriptedMotion& motion) {
  ServedTrialOptions options;
  options.rig_file = arguments.rig;
  options.name = arguments.name;
  if (arguments.delay_ms > 0 || !arguments.line.empty()) options.line = line_of(arguments);
  options.things = task.picks;
  options.thing = task.thing;
  options.tray = task.tray;
  options.most_s = most_seconds(arguments);
  options.pictures_hz = arguments.pictures_hz;
  options.fall_back.lowest_db = arguments.fidelity_db;
  options.textures = in_real_time(arguments.textures);
  options.levels = level_settings(arguments.detail);
  options.out = arguments.outputs.out;
  return try_served_seat(
      rig, std::move(scene), options, motion, [] { return stop_requested(); }, say);
}

int run_scripted(const Rig& given, const Arguments& arguments) {
  Rig rig = given;
  for (const std::string& words : words_on_home(parts_too_close_at_home(rig))) say(words);
  // What the line takes by its file is known; the robot's side is told, as the rig's round_trip_s does.
  const LineSpec line = line_of(arguments);
  if (!arguments.served) rig.link.coding = coding_of(rig, arguments);
  rig.link.round_trip = std::max(rig.link.round_trip, line.up.delay + line.down.delay + seconds(0.5));
  const Task task = task_of(arguments);
  HeadSway sway;
  if (task.picks) sway.middle_pan = sim::kHeadAtTable.pan, sway.middle_tilt = sim::kHeadAtTable.tilt;
  if (arguments.still_head) sway.pan = sway.tilt = 0;
  const bool mock = !arguments.served || arguments.mock;
  const std::optional<fs::path> scene_file =
      arguments.scene.empty() ? std::nullopt : std::optional<fs::path>(arguments.scene);
  const auto scene = std::make_shared<const LiveScene>(
      live_scene_of(rig, mock, arguments.served ? scene_file : std::nullopt, task.picks, task.layout));
  ToolScript script(
      rig, task.picks ? pick_and_place(rig, *scene, task.thing, task.tray) : tour(rig, arguments.seed, 40), sway);
  const SeatTrialFigures figures = arguments.served ? run_served(rig, arguments, task, scene, script)
                                                    : run_stepped(rig, arguments, task, scene, script);
  print(figures);
  ViewOutputs reports = arguments.outputs;
  reports.report.reset();
  write_reports(reports, figures.fidelity.record, figures.fidelity.instants,
                "Foresight, an operator's seat at " + rig.name);
  if (arguments.outputs.report) write_numbers(arguments.outputs.report, report_of(figures, arguments).dump(2));
  return stop_requested() ? kStopped : figures.task.succeeded ? 0 : 1;
}

int run_live(const Rig& rig, const Arguments& arguments) {
  LiveSeatOptions options;
  options.rig_file = arguments.rig;
  options.name = arguments.name;
  if (!arguments.line.empty()) options.line = arguments.line;
  if (!arguments.scene.empty()) options.scene = arguments.scene;
  options.mock_cameras = arguments.mock;
  options.physics = arguments.physics;
  options.layout = arguments.layout;
  options.device = arguments.device;
  options.head_display = arguments.head_display;
  options.second_eye_of_first = arguments.second_eye_of_first;
  options.display_lenses.assign(arguments.display_lenses.begin(), arguments.display_lenses.end());
  options.rate_hz = arguments.rate_hz;
  options.font_scale = arguments.font_scale;
  options.textures = in_real_time(arguments.textures);
  options.levels = level_settings(arguments.detail);
  options.sounds = arguments.sounds;
  options.trust.fall_back.lowest_db = arguments.fidelity_db;
  return run_live_seat(rig, options);
}

/// Options that would change nothing are a mistake of whoever gave them.
void refuse_options_of_the_other_way(const Arguments& given) {
  const Arguments usual;
  const std::pair<const char*, bool> of_scripts[] = {{"--out, --report, --html", given.outputs.any()},
                                                     {"--delay-ms", given.delay_ms != usual.delay_ms},
                                                     {"--still-head", given.still_head},
                                                     {"--served", given.served},
                                                     {"--seed", given.seed != usual.seed},
                                                     {"--seconds", given.seconds.has_value()},
                                                     {"--pictures-hz", given.pictures_hz != usual.pictures_hz},
                                                     {"--no-zero-delay", !given.zero_delay}};
  const std::pair<const char*, bool> of_windows[] = {{"--device", !given.device.empty()},
                                                     {"--rate-hz", given.rate_hz != usual.rate_hz},
                                                     {"--font-scale", given.font_scale != usual.font_scale},
                                                     {"--no-sounds", !given.sounds},
                                                     {"--head-display", given.head_display != usual.head_display}};
  if (!given.script) {
    for (const auto& [name, is_given] : of_scripts)
      if (is_given) throw InputError(name, "belongs to --scripted", "add --scripted, or leave it out");
  } else {
    for (const auto& [name, is_given] : of_windows)
      if (is_given) throw InputError(name, "is of a seat with a window", "leave it out, or --scripted");
  }
}

void check(const Rig& rig, const Arguments& arguments) {
  if (!rig.cameras)
    throw InputError(arguments.rig, "the rig has no cameras, of which a view could be made",
                     "add them to the rig (docs/rig-files.md)");
  if (!arguments.line.empty()) read_line_spec(arguments.line);  // known before anything is opened
  refuse_options_of_the_other_way(arguments);
  if (!arguments.scene.empty() && arguments.script && !arguments.served)
    throw InputError("--scene",
                     "is of a robot that is served: with both sides in one program the scene is the mock lab",
                     "leave it out, or add --served");
  if (arguments.coding && (!arguments.script || arguments.served))
    throw InputError("--coding", "is of --scripted with both sides in one program",
                     "leave it out: the rig of the robot's side says it (link: coding)");
  const bool live = !arguments.script || arguments.served;
  if (arguments.layout != 0 && (!live || !arguments.mock))
    throw InputError("--layout", "is of a robot's side that runs with --mock --physics",
                     live ? "add --mock" : "leave it out: --seed says it, too");
  if (arguments.physics && (arguments.script || !arguments.mock))
    throw InputError("--physics", "is of a robot's side that runs with --mock", "add --mock, without --scripted");
  if (arguments.second_eye_of_first && arguments.head_display != HeadDisplayKind::openxr)
    throw InputError("--second-eye", "is of a headset", "add --head-display openxr");
  if (!arguments.display_lenses.empty() && arguments.head_display != HeadDisplayKind::side_by_side)
    throw InputError("--display-lens", "is of a head display that takes two eyes side by side",
                     "add --head-display side-by-side; a headset of OpenXR corrects its lenses itself");
  for (const std::string& file : arguments.display_lenses) read_panel_lens(file);  // known before anything is opened
  if (arguments.seed == 0) throw InputError("--seed", "is 0", "give one from 1 on");
  if (arguments.name.empty())
    throw InputError("--name", "is empty, and the robot's side shows who is in command",
                     "give a name, or leave it out");
}

/// Who gives the robot's address means the right thing, but in another place.
void refuse_address(const std::string& rig) {
  const bool is_address = rig.find('.') != rig.npos && rig.find_first_not_of("0123456789.:") == rig.npos;
  if (is_address && !fs::exists(rig))
    throw InputError(rig, "is an address, not a rig file",
                     "copy the robot's rig file, write the address under its `link: peers:` (docs/line.md), and give "
                     "that file");
}

int run(const Arguments& arguments) {
  refuse_address(arguments.rig);
  Rig rig = read_rig(arguments.rig);
  check(rig, arguments);
  for (const std::string& words : words_on_groups(rig)) say(words);
  if (arguments.script) return run_scripted(rig, arguments);
  give_start(rig);
  return run_live(rig, arguments);
}

}  // namespace

void add_operator_command(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("operator", "An operator's seat: shows the robot as it will be, and drives it");
  auto arguments = std::make_shared<Arguments>();
  command->add_option("RIG", arguments->rig, "Rig file (docs/rig-files.md)")->reads()->required();
  command->add_option("--name", arguments->name, "Of the operator, as the robot's side shows it (default operator)");
  command->add_flag("--mock", arguments->mock, "The robot's side runs with --mock: its cameras see the mock lab");
  command->add_flag("--physics", arguments->physics,
                    "With --mock: the robot's side runs with --physics, too; things go with the hand at once");
  command->add_option("--layout", arguments->layout,
                      "With --mock: the robot's side has this --layout, too (default 0)");
  command->add_option("--scene", arguments->scene, "The scene around the robot, in place of the rig's `scene:`")
      ->reads();
  command->add_option(
      "--device", arguments->device,
      "Beside keyboard and mouse: gamepad, gamepad:1, spacemouse, or the recording of one (docs/input.md)");
  command->add_choice<HeadDisplayKind>(
      "--head-display", arguments->head_display,
      {{"openxr", HeadDisplayKind::openxr},
       {"side-by-side", HeadDisplayKind::side_by_side},
       {"none", HeadDisplayKind::none}},
      "Beside the window: openxr (a headset, docs/head-display.md), side-by-side, none (default)");
  command->add_choice<bool>(
      "--second-eye", arguments->second_eye_of_first, {{"own", false}, {"first", true}},
      "With --head-display openxr: the right eye's frames are made of a view of its own (own, default), or\n"
      "of the left eye's, row by row (first): cheaper where little is near; its own where that tears");
  command
      ->add_option("--display-lens", arguments->display_lenses,
                   "With --head-display side-by-side: results of `calibrate display`, one for both eyes or the\n"
                   "left one's and the right one's: what is predicted is drawn such that these lenses show it straight")
      ->reads()
      ->expected(1, 2);
  command->add_option("--rate-hz", arguments->rate_hz, "Pictures a second, at most (default 30)")
      ->check(from_to(1.0, 240.0));
  command->add_option("--font-scale", arguments->font_scale, "Of all words in the window (default 1)")
      ->check(from_to(0.5, 4.0));
  command->add_flag("!--no-sounds", arguments->sounds, "Nothing is heard before key F10 asks for it");
  command
      ->add_option("--fidelity-db", arguments->fidelity_db,
                   "The newest image is shown instead where the view was less like the images that came (default 20)")
      ->check(from_to(0.0, 60.0));
  command->add_choice<std::optional<Script>>(
      "--scripted", arguments->script, {{"pick", Script::pick}, {"tour", Script::tour}},
      "A program operates, both sides in stepped time, without a window: pick (a brick into a\ntray), tour");
  command->add_flag(
      "--served", arguments->served,
      "With --scripted: the robot's side is a program of its own (foresight robot --serve), in real time");
  command->add_option("--delay-ms", arguments->delay_ms, "With --scripted: what the line takes each way (default 0)")
      ->check(from_to(0.0, 1e4));
  command->add_option("--line", arguments->line, "File of a line (docs/line.md) that everything passes")->reads();
  command->add_choice<std::optional<LinkCoding>>(
      "--coding", arguments->coding, {{"jpeg", LinkCoding::jpeg}, {"h264", LinkCoding::h264}},
      "With --scripted: of pairs on the line, jpeg or h264 (default: h264 with --line, else the rig's)");
  command->add_option("--seed", arguments->seed, "With --scripted: another seed, another motion");
  command
      ->add_option("--seconds", arguments->seconds, "With --scripted: of motion, at most (default 30, of a pick 120)")
      ->check(from_to(1.0, 1e4));
  command
      ->add_option("--pictures-hz", arguments->pictures_hz, "With --scripted: measured pictures a second (default 5)")
      ->check(from_to(0.1, 60.0));
  command->add_flag("--still-head", arguments->still_head, "With --scripted: the head does not move");
  command->add_flag("!--no-zero-delay", arguments->zero_delay,
                    "With --scripted: does not also draw each view as it would be without a line");
  command->add_flag("!--no-shadows", arguments->textures.shadows,
                    "Shadows of what moves are shown where they were; else where they fall, once it is known where the "
                    "lamp is");
  add_images_option(*command, arguments->textures.images);
  const Option* accumulate = add_accumulate_option(*command, arguments->textures.accumulate);
  command
      ->add_flag("!--no-accumulate", arguments->textures.accumulate,
                 "Show it as it came (default: so on software renderers, for images above 320x240)")
      ->excludes(accumulate);
  add_level_options(*command, arguments->detail);
  add_view_outputs(*command, arguments->outputs, {"shown", "delayed", "true"});
  command->footer(
      "The robot's side is `foresight robot RIG --serve`; both have the same rig file, URDF and calibrations. The "
      "window\n"
      "shows every key. While the left shift key is held, the hand moves the tool; released, the robot comes to rest.\n"
      "A software stop does not replace a hardware emergency stop.\n\n"
      "Exit codes: 0 done, 1 the script failed or a device did, 2 wrong input, 130 Ctrl-C or SIGTERM.\n\n"
      "Example: foresight robot configs/minerva.yaml --mock --serve, and in another terminal\n"
      "foresight operator configs/minerva.yaml --mock");
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace foresight
