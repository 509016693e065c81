#include "apps/robot_command.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include "apps/live_view.hpp"
#include "apps/recording_outputs.hpp"
#include "apps/rig_feed.hpp"
#include "apps/robot/console.hpp"
#include "apps/run_options.hpp"
#include "common/error.hpp"
#include "common/patient_output.hpp"
#include "common/real_time.hpp"
#include "common/stop_signal.hpp"
#include "link/dds/pretended_line.hpp"
#include "link/robot_side/rig_identity.hpp"
#include "link/robot_side/robot_server.hpp"
#include "rig/home_check.hpp"
#include "rig/joint_groups.hpp"
#include "scene/target_folder.hpp"
#include "session/robot_loop.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTick = 10ms;

struct RobotArguments {
  std::string rig;
  std::string follow;
  std::string log, record, session;
  std::string line;  // with `serve`
  bool cameras = true;
  bool mock = false, stepped = false, may_home = false, check_only = false;
  bool rig_view = false, serve = false;
  bool physics = false;
  unsigned physics_seed = 1, layout = 0;
  bool view = false, window = false;  // the rest only with `view`
  std::optional<double> delay_ms;
  std::string scene;
  ViewOutputs outputs;
  std::vector<std::string> faults;
};

/// What shows the robot; at most one of them.
struct Windows {
  std::unique_ptr<LiveView> view;
  std::unique_ptr<RigBody> body;  // of `rig`
  std::unique_ptr<RigWindow> rig;
};

/// At once: what has to end first, such as a camera that is being opened, may take seconds.
void tell_of_signal() {
  if (stop_requested()) say_robot(std::string("stopped by ") + stopped_by() + ": drives and cameras end");
}

/// A window that fails ends, and the robot with it, under control.
void run_guarded(RigWindow& window, const std::function<bool()>& stopped) noexcept {
  try {
    window.run(stopped);
  } catch (const std::exception& error) {
    say_robot(error.what());
  }
}

int run_stepped(SteppedClock& clock, Robot& robot, Console& console, RobotDevices& devices, RobotCameras* cameras,
                const Windows& windows) {
  LiveView* const view = windows.view.get();
  devices.bring_up(say_robot);
  std::stop_source stop;
  if (cameras) clock.every(kTick, [cameras](RobotTime) { cameras->step(); });
  clock.every(kTick, [&](RobotTime now) {
    if (view && !view->step()) stop.request_stop();
    if (!stop.stop_requested() && (!console.tick(now) || stop_requested())) stop.request_stop();
  });
  robot.run(clock, stop.get_token());
  tell_of_signal();
  const int code = console.finish();
  if (view) view->finish(!stop_requested(), console.trouble());
  return stop_requested() ? kStopped : code;
}

int run_real(MonotonicClock& clock, Robot& robot, Console& console, RobotDevices& devices, RobotCameras* cameras,
             const Windows& windows) {
  LiveView* const view = windows.view.get();
  std::exception_ptr failure;
  {
    const RobotLoop loop(clock, robot, devices, say_robot);
    if (cameras) cameras->start();  // the drives already wait for the loop: that goes first
    notify_service("READY=1");
    std::atomic<bool> ended = false, unseen = false;
    const auto tick_on = [&] {
      for (RobotTime due = clock.now(); !stop_requested() && !unseen && console.tick(due);
           due = std::max(due + kTick, clock.now()))
        clock.sleep_until(due + kTick);
      tell_of_signal();
      ended = true;
    };
    // A window wants the main thread, and neither drawing nor a busy machine must make commands late.
    std::jthread ticks([&] {
      make_real_time(priority::kLine);  // where allowed
      try {
        tick_on();
      } catch (...) {
        failure = std::current_exception();
        ended = true;
      }
    });
    if (view || windows.rig) {
      const auto stopped = [&] { return ended.load(); };
      if (view)
        view->run(stopped);
      else
        run_guarded(*windows.rig, stopped);
      unseen = true;
    }
    ticks.join();
    notify_service("STOPPING=1");
  }
  const int code = console.finish();
  if (failure) std::rethrow_exception(failure);
  if (view) view->finish(!stop_requested(), console.trouble());
  return stop_requested() ? kStopped : code;
}

/// Null where there are none to run. In stepped time, pictures that nobody keeps are not drawn.
std::unique_ptr<RobotCameras> make_cameras(const Rig& rig, const RobotDevices& devices, const Robot& robot,
                                           Clock& clock, const RobotArguments& arguments) {
  if (!rig.cameras || !arguments.cameras || (arguments.stepped && arguments.record.empty() && !arguments.view))
    return nullptr;
  if (!arguments.record.empty())
    for (const std::filesystem::path& cut : unfinished_beside(arguments.record))
      say_robot(cut.string() + " is a recording that was not finished: rename it, or remove it");
  RobotCameraOptions options;
  options.mock = arguments.mock;
  if (!arguments.record.empty()) options.record = arguments.record;
  options.frames = arguments.view || arguments.serve;
  if (!arguments.scene.empty()) options.scene = arguments.scene;
  options.physics = arguments.physics;
  options.physics_seed = arguments.physics_seed;
  options.layout = arguments.layout;
  if (options.mock || rig.cameras->mock()) say_robot("lighting the lab");
  return std::make_unique<RobotCameras>(rig, devices, robot, clock, options);
}

/// Null without --view.
std::unique_ptr<LiveView> make_view(const Rig& rig, const Robot& robot, RobotCameras* cameras, const Clock& clock,
                                    const RobotArguments& arguments) {
  if (!arguments.view || !cameras) return nullptr;
  constexpr std::size_t kRoom = 64;
  const LiveViewOptions options{rig.name,
                                arguments.delay_ms.value_or(0),
                                arguments.outputs,
                                arguments.window || !arguments.outputs.any(),
                                arguments.stepped,
                                [&rig, &robot] {
                                  const RobotStatus status = robot.status();
                                  return hold_text(status.gate.hold, rig.joint_words(), status.time);
                                }};
  const auto trouble = [cameras] { return cameras->watch().line().fault; };
  return std::make_unique<LiveView>(cameras->scene(), cameras->frames().subscribe(kRoom), trouble, clock, options);
}

/// `other`: link::robot_beside().
void require_alone(const std::string& other, const std::string& rig) {
  if (!other.empty())
    throw InputError(rig, "cannot be served beside " + other + ": an operator would see the one and move the other",
                     "end the other one, or give this rig another link.domain");
}

/// Before a lab is lit and cameras are opened, which takes seconds. One that comes meanwhile, make_server() sees.
void require_free_domain(const Rig& rig, Clock& clock, const RobotArguments& arguments) {
  if (!arguments.serve || !rig.cameras || !arguments.cameras) return;
  const link::Participant program(rig.link, "robot " + rig.name, link::Role::robot);
  clock.sleep_until(clock.now() + link::kAllHeardOf);
  require_alone(link::robot_beside(program), arguments.rig);
}

/// Null without --serve.
std::unique_ptr<link::RobotServer> make_server(const Rig& rig, const Robot& robot, RobotCameras* cameras, Clock& clock,
                                               const RobotArguments& arguments) {
  if (!arguments.serve) return nullptr;
  std::shared_ptr<link::PretendedLine> line;
  if (!arguments.line.empty()) {
    line =
        std::make_shared<link::PretendedLine>(read_line_spec(arguments.line), link::PretendedLine::Side::robot, clock);
    line->start();
    say_robot("everything on the line passes " + arguments.line);
  }
  auto server = std::make_unique<link::RobotServer>(
      rig, robot, cameras, link::rig_identity(rig, arguments.rig, FORESIGHT_VERSION), clock, std::move(line));
  clock.sleep_until(clock.now() + link::kAllHeardOf);
  require_alone(server->robot_beside(), arguments.rig);
  say_robot("serving on " + rig.link.place());
  if (const std::string trouble = link::receive_buffer_trouble(); !trouble.empty()) say_robot(trouble);
  return server;
}

ConsoleOptions console_options(const RobotArguments& arguments, link::RobotServer* server) {
  ConsoleOptions options;
  if (server) {
    options.line = [server] { return server->line(); };
    options.line_news = [server](RobotTime now) { return server->news(now); };
    options.line_stopper = [server] { return server->stopper(); };
  }
  if (server && arguments.follow.empty()) {
    options.commander = &server->commander();
    options.give_control = [server](RobotTime now) { server->give_control(now); };
  }
  options.follow = arguments.follow;
  options.may_home = arguments.may_home;
  if (!arguments.record.empty()) options.joints = joint_log_beside(arguments.record);
  options.session = arguments.session;
  options.faults = arguments.faults;
  options.mock = arguments.mock;
  return options;
}

template <typename ClockKind>
int run_with(const Rig& rig, const RobotArguments& arguments,
             int (*run)(ClockKind&, Robot&, Console&, RobotDevices&, RobotCameras*, const Windows&)) {
  ClockKind clock;
  RobotDeviceOptions options;
  options.mock = arguments.mock;
  if (!arguments.record.empty()) options.log = can_log_beside(arguments.record);
  if (!arguments.log.empty()) options.log = arguments.log;
  RobotDevices devices(rig, clock, options);
  const auto shape = rig.shape();
  say_robot(shape ? to_text(guarded_links(*rig.robot))
                  : "the rig has no robot.urdf: nothing is checked against the surroundings");
  if (shape)
    for (const auto& [link, other] : shape->nested())
      say_robot("links " + other + " and " + link + " lie in each other in most positions: the gate lets them touch");
  const std::vector<TooClose> close_at_home = parts_too_close_at_home(rig);
  for (const std::string& words : words_on_home(close_at_home)) say_robot(words);
  for (const std::string& words : words_on_groups(rig)) say_robot(words);
  if (arguments.check_only) {
    devices.bring_up(say_robot);
    for (const Drive* drive : devices.drives())
      say_robot("drive " + drive->config().name + ": " + to_text(drive->identity()));
    const auto touching = std::ranges::find_if(close_at_home, &TooClose::touch);
    if (touching != close_at_home.end())
      throw RuntimeFailure("the robot could not move freely from home", touching->cure);
    return 0;
  }
  Robot robot(rig.gate_options(), shape.get(), devices.networks(), devices.drives());
  require_free_domain(rig, clock, arguments);
  const auto cameras = make_cameras(rig, devices, robot, clock, arguments);
  Windows windows;
  windows.view = make_view(rig, robot, cameras.get(), clock, arguments);
  if (arguments.rig_view) {
    windows.body = std::make_unique<RigBody>(
        rig, arguments.scene.empty() ? std::nullopt : std::optional<std::filesystem::path>(arguments.scene));
    windows.rig = std::make_unique<RigWindow>(
        *windows.body,
        RigWindowOptions{"Foresight rig: " + rig.name, windows.body->rest(), 1320, 860, rig_feed(rig, robot)});
  }
  const auto server = make_server(rig, robot, cameras.get(), clock, arguments);
  Console console(rig, devices, robot, cameras.get(), console_options(arguments, server.get()));
  poll_stop_signals(SecondSignal::waits);  // a program that ends at once leaves the stop to the drives
  if (const std::string refused = arguments.stepped ? "" : lock_memory(); !refused.empty()) say_robot(refused);
  if (server) server->start();
  return run(clock, robot, console, devices, cameras.get(), windows);
}

void check_rig_view(const RobotArguments& arguments) {
  if (!arguments.rig_view) return;
  for (const auto& [given, other] : {std::pair{arguments.view, "--view"}, {arguments.stepped, "--stepped"}})
    if (given)
      throw InputError("--rig-view", std::string("stands beside ") + other,
                       "leave one out; `foresight rig view RIG --out` draws without a window");
}

void check_view(const Rig& rig, const RobotArguments& arguments) {
  const bool asked[] = {arguments.delay_ms.has_value(), arguments.outputs.out.has_value(),
                        arguments.outputs.report.has_value(), arguments.outputs.html.has_value(), arguments.window};
  const char* const names[] = {"--delay-ms", "--out", "--report", "--html", "--window"};
  if (!arguments.scene.empty() && !arguments.view && !arguments.rig_view && arguments.record.empty())
    throw InputError("--scene", "belongs to --view, --rig-view or --record", "add one of them, or leave it out");
  if (!arguments.view) {
    for (std::size_t i = 0; i < std::size(asked); ++i)
      if (asked[i]) throw InputError(names[i], "belongs to --view", "add --view, or leave it out");
    return;
  }
  if (!rig.cameras || !arguments.cameras)
    throw InputError("--view", rig.cameras ? "stands beside --no-cameras" : "the rig has no cameras",
                     rig.cameras ? "leave one out" : "add them to the rig (docs/rig-files.md)");
}

void check_physics(const Rig& rig, const RobotArguments& arguments) {
  if (arguments.physics_seed != RobotArguments{}.physics_seed && !arguments.physics)
    throw InputError("--physics-seed", "belongs to --physics", "add --physics, or leave it out");
  if (arguments.layout != 0 && !arguments.physics)
    throw InputError("--layout", "belongs to --physics", "add --physics, or leave it out");
  if (!arguments.physics) return;
  if (!rig.cameras || !arguments.cameras || (!arguments.mock && !rig.cameras->mock()))
    throw InputError("--physics", "belongs to the mock lab, which mock cameras look at",
                     "give a rig with cameras, and --mock");
}

/// What the OutputGuard cannot know: the rig says how many logs there are, and how they are called.
void check_logs(const Rig& rig, const RobotArguments& arguments) {
  namespace fs = std::filesystem;
  if (arguments.log.empty() || rig.buses.size() < 2) return;
  if (fs::exists(arguments.log) && !fs::is_regular_file(arguments.log))
    throw InputError("--log " + arguments.log, "is no file, and the rig's buses have a log each",
                     "give the name of a file: each bus's goes before its extension");
  if (arguments.session.empty()) return;
  for (const RigBus& bus : rig.buses) {
    const fs::path log = log_of(arguments.log, rig, bus);
    if (fs::weakly_canonical(log) == fs::weakly_canonical(arguments.session))
      throw InputError("--session-html " + arguments.session, "is the log of bus '" + bus.name + "', too",
                       "give another name");
  }
}

int run(const RobotArguments& arguments) {
  const WaitsForReaders waits;
  const Rig rig = read_rig(arguments.rig);
  check_logs(rig, arguments);
  check_rig_view(arguments);
  check_view(rig, arguments);
  check_physics(rig, arguments);
  parse_mock_faults(arguments.faults, rig, arguments.mock);
  if (!arguments.record.empty() && (!rig.cameras || !arguments.cameras))
    throw InputError("--record", rig.cameras ? "stands beside --no-cameras" : "the rig has no cameras",
                     rig.cameras ? "leave one out" : "add them to the rig (docs/rig-files.md)");
  if (!arguments.line.empty() && !arguments.serve)
    throw InputError("--line", "belongs to --serve", "add --serve, or leave it out");
  if (!arguments.line.empty()) read_line_spec(arguments.line);  // known before anything moves
  if (arguments.serve && arguments.stepped)
    throw InputError("--serve", "stands beside --stepped: a network's time cannot be stepped", "leave one of them out");
  if (!arguments.stepped) return run_with<MonotonicClock>(rig, arguments, run_real);
  require_mock(rig, arguments.mock, arguments.view || !arguments.record.empty());
  return run_with<SteppedClock>(rig, arguments, run_stepped);
}

}  // namespace

void add_robot_command(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand("robot", "Runs the robot side of a rig: drives behind a safety gate");
  auto arguments = std::make_shared<RobotArguments>();
  command->add_option("RIG", arguments->rig, "Rig file (docs/rig-files.md)")->reads()->required();
  command->add_flag("--mock", arguments->mock,
                    "Emulated drives on every bus, and the mock lab before the cameras, whatever the rig says");
  command
      ->add_option("--follow", arguments->follow,
                   "CSV file with the columns time_s and names of joints; enables, follows it and ends")
      ->reads();
  command->add_flag("--home", arguments->may_home,
                    "Consent: with --follow, joints that are not homed look for home, slowly");
  command->add_option("--log", arguments->log, "candump log of all frames: FILE, or FILE-BUS of each bus")
      ->writes(can_log_outputs);
  command
      ->add_option("--session-html", arguments->session,
                   "Report of the session: what the robot did and why, every joint over time, the buses' load; the\n"
                   "plots' series as JSON beside it")
      ->writes(page_outputs);
  command
      ->add_option("--record", arguments->record,
                   "Writes what the cameras see as a run into this folder, and beside it the CAN logs\n"
                   "(OUT-can-BUS.log) and the joints (OUT-joints.csv, as --follow reads them)")
      ->writes(robot_recording_outputs);
  command->add_flag("--view", arguments->view,
                    "Shows the live scene beside the camera's image; its textures are as old as --delay-ms says");
  command->add_option("--delay-ms", arguments->delay_ms, "With --view: delay of images in milliseconds (default 0)")
      ->check(from_to(0.0, 1e4));
  add_view_outputs(*command, arguments->outputs);
  command->add_flag("--window", arguments->window, "With --view: a window also where pictures or reports are written");
  command->add_flag("--rig-view", arguments->rig_view,
                    "Shows the robot in three dimensions as it moves, with what the gate guards (foresight rig view)");
  command
      ->add_option("--scene", arguments->scene,
                   "With --view, --rig-view or --record: the scene around the robot, in place of the rig's `scene:`")
      ->reads();
  command->add_flag(
      "--physics", arguments->physics,
      "With mock cameras: the mock lab's things, and bricks and a tray besides, can be grasped, pushed and\n"
      "dropped, and throw their shadows where they are");
  command->add_option("--physics-seed", arguments->physics_seed,
                      "With --physics: of how masses, friction and places differ from the model's (default 1)");
  command->add_option("--layout", arguments->layout,
                      "With --physics: of bricks and tray, another number another one (default 0)");
  command->add_flag("!--no-cameras", arguments->cameras, "Leaves the rig's cameras alone");
  command->add_flag(
      "--serve", arguments->serve,
      "Publishes pairs, joints, transforms and states on the network that the rig's `link:` section names, and\n"
      "lets one operator there command at a time (docs/line.md); whoever listens cannot hold the robot up");
  command
      ->add_option(
          "--line", arguments->line,
          "With --serve: file of a line (docs/line.md) that everything passes on its way out and in, to try out\n"
          "what a network does")
      ->reads();
  command->add_flag("--stepped", arguments->stepped,
                    "As fast as the machine can, the same on every run; only with mock drives");
  command->add_option("--fault", arguments->faults,
                      "JOINT:KIND@TIME: what goes wrong with a mock drive, so many seconds after the start: stuck,\n"
                      "following_error, lost_node, noisy_encoder or lost_power; again for more");
  command->add_flag("--check", arguments->check_only,
                    "Only identify and configure the drives, and see that the robot stands clear at home; move\n"
                    "nothing");
  command->footer(
      "On a terminal, keys enable, home, move and stop the robot; space is a stop; g gives control to who\n"
      "asks for it over the line. A software stop does not replace a hardware emergency stop. The drives stop on "
      "their\n"
      "own when this program ends in whatever way.\n\n"
      "Exit codes: 0 done, 1 stopped, held back or a device failed, 2 wrong input, 130 Ctrl-C or SIGTERM.\n\n"
      "Example: foresight robot configs/minerva.yaml --mock --home --follow motion.csv --log session.log");
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace foresight
