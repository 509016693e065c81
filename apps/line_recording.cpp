#include "apps/line_recording.hpp"

#include <fmt/core.h>

#include <cstdio>

#include "apps/command_line/named_files.hpp"
#include "common/clock.hpp"
#include "common/error.hpp"
#include "common/read_file.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "link/control/motion_permit.hpp"
#include "link/recording/line_recorder.hpp"
#include "link/recording/playback.hpp"
#include "link/recording/rig_files.hpp"
#include "link/recording/run_export.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kTake = 4ms;
constexpr Duration kLookEvery = 500ms;
constexpr Duration kLinger = 1s;

void say(const char* command, const std::string& words) {
  std::fprintf(stderr, "%s: %s\n", command, words.c_str());
}

/// Metadata, and the rig's files, before all messages: whatever ends the recording, they are in it.
void write_head(link::RecordingFile& file, const RecordLineOptions& options, const LinkConfig& config,
                std::int64_t now_ns) {
  link::McapTexts facts{
      {"program", std::string("foresight ") + FORESIGHT_VERSION},
      {"mock", options.mock ? "yes" : "no"},
      {"domain", std::to_string(config.domain)},
      {"log_time", "when the recorder took a message: its host's monotonic clock, at the start set to its wall clock"},
      {"publish_time", "when a message was written: the wall clock of its writer's host"}};
  if (!options.place.rig.empty()) {
    const auto files = with_named_files(options.place.rig);
    facts["rig"] = link::attach_rig(file.head(), files, now_ns);
  } else {
    say("record", "without --rig, the recording does not know lenses and scene: `export-run` will ask for the rig");
  }
  file.head().add_metadata(link::kRecordingFacts, facts);
}

std::string counts_text(const link::RecordingCounts& counts, std::uint64_t lost) {
  std::string out = fmt::format("{} messages, {:.1f} MB", counts.written, 1e-6 * static_cast<double>(counts.bytes));
  if (counts.dropped) out += fmt::format("; {} dropped: the disk was too slow or full", counts.dropped);
  if (lost) out += fmt::format("; {} lost on the way", lost);
  return out;
}

constexpr const char* kOtherDomain = "play it on another domain (--domain), or end the robot's program first";

/// Waits until `due` while nobody stops it. False: somebody did.
bool wait_until(MonotonicClock& clock, RobotTime due) {
  while (!stop_requested() && clock.now() < due) clock.sleep_until(std::min(due, clock.now() + 50ms));
  return !stop_requested();
}

/// Sends what a Playback says, when it says so.
class Player {
 public:
  Player(const PlayOptions& options, link::Participant& program)
      : options_(options),
        program_(program),
        playback_(start_, link::WallClock::machine_unix_ns() + kStart.count(), playback_options(options)) {}

  bool send(const link::McapMessage& recorded) {
    for (link::Playback::Message& message : playback_.take(recorded)) {
      auto& writer = writers_[message.topic->name];
      if (!writer) writer = std::make_unique<link::Writer>(program_, *message.topic);
      if (!wait_until(clock_, message.due)) return false;
      writer->write(std::move(message.cdr));
      ++sent_;
      if (clock_.now() < look_due_) continue;
      look_due_ = clock_.now() + kLookEvery;
      if (const std::string robot = link::robot_beside(program_); !robot.empty())
        throw RuntimeFailure("the recording stopped beside " + robot + ", which has just come", kOtherDomain);
    }
    return !stop_requested();
  }

  void report(const link::McapOutcome& outcome) const {
    constexpr std::size_t kShown = 20;
    std::string left;
    std::size_t shown = 0;
    for (const auto& [topic, count] : playback_.left_out()) {
      if (++shown > kShown) continue;
      left += fmt::format("{}{} ({})", left.empty() ? "" : ", ", in_quotes(topic), count);
    }
    if (shown > kShown) left += fmt::format(" and {} more", shown - kShown);
    say("play", fmt::format("{} messages", sent_));
    if (!left.empty()) say("play", "not played, as the robot does not say it or somebody could follow it: " + left);
    if (const auto& pieces = playback_.pieces(); pieces.came && pieces.pairs == 0)
      say("play", link::RecordedStream::kNothingWhole);
    if (playback_.damaged()) say("play", fmt::format("{} messages are damaged", playback_.damaged()));
    if (!outcome.trouble.empty()) say("play", "the recording is cut: " + outcome.trouble);
  }
  std::uint64_t sent() const { return sent_; }
  const link::Playback& playback() const { return playback_; }

 private:
  static constexpr Duration kStart = 300ms;  // until the first message: readers have to find its topic

  static link::PlaybackOptions playback_options(const PlayOptions& options) {
    return {options.rate, seconds(options.from), machine_nonces()()};
  }

  const PlayOptions& options_;
  link::Participant& program_;
  MonotonicClock clock_;
  RobotTime start_ = clock_.now() + kStart;
  link::Playback playback_;
  std::map<std::string, std::unique_ptr<link::Writer>> writers_;
  RobotTime look_due_;
  std::uint64_t sent_ = 0;
};

}  // namespace

int record_line(const RecordLineOptions& options) {
  poll_stop_signals();
  const LinkConfig config = link_config_of(options.place);
  MonotonicClock clock;
  link::Participant program(config, "recorder");
  link::RecordingFile file(options.file, clock);
  link::LineRecorder recorder(program, file, clock, {options.pictures});
  const RobotTime begin = clock.now();
  write_head(file, options, config, recorder.log_ns(begin));
  file.start();
  say("record", fmt::format("listening on domain {}, interface {}", config.domain, config.interface));
  if (const std::string trouble = link::receive_buffer_trouble(); !trouble.empty()) say("record", trouble);
  while (!stop_requested() && file.trouble().empty() &&
         (!options.seconds || clock.now() - begin < seconds(*options.seconds))) {
    recorder.step(clock.now());
    for (const std::string& news : recorder.take_news()) say("record", news);
    clock.sleep_until(clock.now() + kTake);
  }
  file.finish(recorder.remarks());
  const std::string trouble = file.trouble();
  say("record", counts_text(file.counts(), recorder.lost()));
  if (!trouble.empty()) {
    say("foresight", trouble + "; what came before is in " + options.file);
    return 1;
  }
  std::printf("%s\n", options.file.c_str());
  if (recorder.came() > 0) return 0;
  say("foresight", "nothing came; see `foresight link status`, and `foresight robot RIG --serve`");
  return 1;
}

int play(const PlayOptions& options) {
  poll_stop_signals();
  std::ifstream stream = open_input(options.file, UINTMAX_MAX);
  const std::string name = "robot played from " + std::filesystem::path(options.file).filename().string();
  link::Participant program(link_config_of(options.place), name, link::Role::robot);
  MonotonicClock clock;
  if (!wait_until(clock, clock.now() + link::kAllHeardOf)) return kStopped;
  if (const std::string robot = link::robot_beside(program); !robot.empty())
    throw InputError(options.file,
                     "cannot be played beside " + robot + ": an operator would see the recording and move the robot",
                     kOtherDomain);
  Player player(options, program);
  link::McapVisitor visitor;
  visitor.message = [&](const link::McapMessage& message) { return player.send(message); };
  visitor.wants_chunk = [&](std::int64_t end_ns, auto channels) {
    return player.playback().wants_chunk(end_ns, channels);
  };
  const link::McapOutcome outcome = link::read_mcap(stream, options.file, visitor);
  player.report(outcome);
  if (stop_requested()) return kStopped;
  if (player.sent() == 0)
    throw InputError(options.file,
                     "has nothing that a robot says" + (outcome.trouble.empty() ? "" : "; " + outcome.trouble),
                     "record with `foresight record --line` while `foresight robot --serve` runs");
  wait_until(clock, clock.now() + kLinger);  // for who asks for the last messages again
  return 0;
}

int export_run(const ExportRunOptions& options) {
  link::RunExportOptions wanted{options.file, options.out, {}, {}, options.mock};
  if (!options.rig.empty()) wanted.rig = options.rig;
  if (!options.scene.empty()) wanted.scene = options.scene;
  const link::RunExport run = link::export_run(wanted);
  std::fputs(run.remarks.c_str(), stderr);
  say("export-run", fmt::format("{} pairs, {} of them without a pose", run.pairs, run.without_pose));
  std::printf("%s\n", options.out.c_str());
  if (run.fault.empty()) return 0;
  say("foresight", run.fault + "; what came before is in " + options.out);
  return 1;
}

}  // namespace foresight
