#include "apps/bench/link_bench.hpp"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "apps/bench/child_process.hpp"
#include "apps/bench/temporary_folder.hpp"
#include "apps/command_line/picture_size.hpp"
#include "common/error.hpp"
#include "common/latest_value.hpp"
#include "common/numbers_file.hpp"
#include "common/resident_memory.hpp"
#include "common/statistics.hpp"
#include "common/unique_fd.hpp"
#include "link/coding/jpeg_coder.hpp"
#include "link/dds/topics.hpp"
#include "link/operator_side/pair_intake.hpp"
#include "link/robot_side/frame_sender.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kReaderWait = 100ms;
constexpr std::size_t kPictures = 16;

/// What the receiving process tells of each pair.
struct Arrival {
  enum Kind : std::uint8_t { came, decoded };
  std::uint64_t number;
  Kind kind;
  double ms;  ///< what the line added or, where it was decoded, how long that took; -1: it was damaged
  double age_ms, coder_ms;
  std::uint64_t bytes;
  double memory_mb;
};

double ms(std::int64_t ns) {
  return 1e-6 * static_cast<double>(ns);
}

void write_all(int fd, const Arrival& arrival) {
  const auto* at = reinterpret_cast<const char*>(&arrival);  // less than PIPE_BUF: whole, or not at all
  while (::write(fd, at, sizeof arrival) < 0 && errno == EINTR) {
  }
}

/// Decodes the newest pair, as an operator's program does beside the one that receives.
void decode(LatestValue<link::StereoFrame>& newest, const Clock& clock, int to, const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const auto frame = newest.take(kReaderWait);
    if (!frame) continue;
    const std::int64_t begin = clock.now().ns;
    const auto decoded = [](const link::CodedImage& image) {
      return decode_jpeg(image.data, {static_cast<int>(image.width), static_cast<int>(image.height)}, true);
    };
    const bool whole = decoded(frame->left) && decoded(frame->right);
    write_all(to, {frame->number, Arrival::decoded, whole ? ms(clock.now().ns - begin) : -1, 0, 0, 0, resident_mb()});
  }
}

/// Pairs that come in pieces: decoded as they become whole, in their order.
[[noreturn]] void receive_pieces(link::Participant& program, const Clock& clock, int to) {
  constexpr Duration kPoll = 5ms;  // an acknowledgement may be due
  link::PairIntake intake(1, {}, clock);
  link::Reader reader(program, link::topics::pieces());
  link::Writer reports(program, link::topics::reports());
  std::uint64_t bytes = 0;  // since the last pair
  for (;;) {
    reader.wait(kPoll);
    reader.take<link::StereoPiece>({}, [&](link::StereoPiece&& piece, const link::Sample& sample) {
      bytes += sample.cdr.size();
      const link::LineFramePtr frame = intake.take(piece, RobotClockTracker());
      if (!frame) return;
      const std::int64_t captured = frame->image[0].captured.ns, coded = captured + frame->ages.coded->count();
      write_all(to, {frame->number, Arrival::came, ms(frame->arrived.ns - coded), ms(frame->arrived.ns - captured),
                     ms((*frame->ages.coded - *frame->ages.taken).count()), std::exchange(bytes, 0), resident_mb()});
      write_all(to,
                {frame->number, Arrival::decoded, ms(frame->decoded.ns - frame->arrived.ns), 0, 0, 0, resident_mb()});
    });
    if (const auto report = intake.report()) reports.write(*report);
  }
}

/// The operator's end, until it is killed.
[[noreturn]] void receive(const LinkConfig& config, bool coded, int to) {
  MonotonicClock clock;
  LatestValue<link::StereoFrame> newest;
  const std::jthread decoder([&](const std::stop_token& stop) { decode(newest, clock, to, stop); });
  link::Participant program(config, "bench receiver", link::Role::operating);
  if (coded) receive_pieces(program, clock, to);
  link::Reader reader(program, link::topics::frames());
  for (;;) {
    reader.wait(kReaderWait);
    reader.take<link::StereoFrame>({}, [&](link::StereoFrame&& frame, const link::Sample& sample) {
      const std::int64_t here = clock.now().ns;
      write_all(to, {frame.number, Arrival::came, ms(here - frame.stamps.coded_ns), ms(here - frame.left.capture_ns),
                     ms(frame.stamps.coded_ns - frame.stamps.taken_ns), sample.cdr.size(), resident_mb()});
      newest.put(std::move(frame));
    });
  }
}

/// Noise on a smooth ground, as cameras deliver it; another picture each time, and as hard to code.
std::vector<cv::Mat> pictures(cv::Size size) {
  std::vector<cv::Mat> out;
  cv::RNG random(1);
  cv::Mat ground(size / 16, CV_8UC3);
  random.fill(ground, cv::RNG::UNIFORM, 30, 220);
  cv::resize(ground, ground, size, 0, 0, cv::INTER_CUBIC);
  for (std::size_t i = 0; i < kPictures; ++i) {
    cv::Mat noise(size, CV_16SC3), picture;
    random.fill(noise, cv::RNG::NORMAL, 0, 4);
    ground.convertTo(picture, CV_16SC3);
    cv::Mat(picture + noise).convertTo(picture, CV_8UC3);
    out.push_back(picture);
  }
  return out;
}

cv::Size parse_size(const std::string& text) {
  const auto [width, height] = size_option(text, {16, 16}, {8192, 8192});
  return {width, height};
}

struct Arrivals {
  std::vector<Arrival> came, decoded;
};

void take_arrivals(int from, Arrivals& out) {
  Arrival one;
  while (::read(from, &one, sizeof one) == sizeof one)
    (one.kind == Arrival::came ? out.came : out.decoded).push_back(one);
}

struct Sent {
  std::uint64_t pairs = 0;
  double memory_mb_first = 0, memory_mb_last = 0;
};

/// Who waits for pairs, of either coding.
std::size_t receivers(const link::Writer& frames, const link::FrameSender& sender, bool coded) {
  return coded ? sender.counts().watched : frames.readers();
}

Sent send(const LinkConfig& config, const LinkBenchOptions& options, cv::Size size, int from, Arrivals& arrivals) {
  const bool coded = options.coding == "h264";
  MonotonicClock clock;
  link::WallClock wall(clock);
  const auto all = pictures(size);
  link::Participant program(config, "bench sender", link::Role::robot);
  const auto queue = std::make_shared<FrameQueue>(2);
  link::FrameSender sender(program, {1, {}}, nullptr, queue,
                           {coded ? LinkCoding::h264 : LinkCoding::jpeg, options.quality, 2 * options.rate_hz}, wall,
                           clock);
  sender.start();
  const link::Writer probe(program, link::topics::frames());
  const RobotTime patience = clock.now() + 10s;
  while (receivers(probe, sender, coded) == 0) {
    if (clock.now() > patience) throw RuntimeFailure("the receiver was not found", "see `foresight link status`");
    clock.sleep_until(clock.now() + 10ms);
  }
  Sent out;
  const Duration period = seconds(1 / options.rate_hz);
  const auto count = static_cast<std::uint64_t>(options.seconds * options.rate_hz);
  RobotTime due = clock.now();
  for (std::uint64_t i = 1; i <= count; ++i, due = due + period) {
    clock.sleep_until(due);
    auto frame = std::make_shared<LiveFrame>();
    frame->number = i;
    frame->pair.left.time = frame->pair.right.time = clock.now();
    frame->pair.left.bgr = all[i % kPictures];
    frame->pair.right.bgr = all[(i + kPictures / 2) % kPictures];
    queue->put(frame);
    take_arrivals(from, arrivals);
    if (i == count / 10 + 1) out.memory_mb_first = resident_mb();
  }
  clock.sleep_until(clock.now() + 500ms);
  take_arrivals(from, arrivals);
  out.pairs = sender.counts().sent;
  out.memory_mb_last = resident_mb();
  return out;
}

template <typename Get>
std::vector<double> column(const std::vector<Arrival>& from, Get&& get, double begin = 0, double end = 1) {
  std::vector<double> out;
  const auto at = [&](double share) { return static_cast<std::size_t>(share * static_cast<double>(from.size())); };
  for (std::size_t i = at(begin); i < at(end); ++i) out.push_back(get(from[i]));
  return out;
}

}  // namespace

int bench_link(const LinkBenchOptions& options) {
  const cv::Size size = parse_size(options.size);
  LinkConfig config;
  config.domain = options.domain;
  config.where = "bench link";
  std::optional<TemporaryFolder> keys;
  if (options.secured) {
    config.security = keys.emplace().path();
    link::make_keys(keys->path(), 1);
  }
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw RuntimeFailure("no pipe can be made", "end other programs");
  const UniqueFd from(ends[0]), to(ends[1]);
  const pid_t receiver =  // before any of our threads
      start_child([&] { receive(config, options.coding == "h264", to.get()); });
  Arrivals all_arrivals;
  Sent sent;
  const auto end_receiver = [&] {
    ::kill(receiver, SIGKILL);
    wait_for_child(receiver);
  };
  try {
    sent = send(config, options, size, from.get(), all_arrivals);
  } catch (...) {
    end_receiver();
    throw;
  }
  end_receiver();
  const std::vector<Arrival>& arrivals = all_arrivals.came;
  if (arrivals.empty()) throw RuntimeFailure("no pair arrived", "see `foresight link status`");

  const auto added = column(arrivals, [](const Arrival& a) { return a.ms; });
  const auto age = [&](double begin, double end) {
    return median(column(
        arrivals, [](const Arrival& a) { return a.age_ms; }, begin, end));
  };
  const auto damaged = std::ranges::count(all_arrivals.decoded, -1.0, &Arrival::ms);
  const auto lost = static_cast<long long>(sent.pairs) - static_cast<long long>(arrivals.size()) + damaged;
  const double p50 = quantile(added, 0.5), p99 = quantile(added, 0.99), worst = quantile(added, 1);
  const double kilobytes = 1e-3 * median(column(arrivals, [](const Arrival& a) { return double(a.bytes); }));
  const double coder = median(column(arrivals, [](const Arrival& a) { return a.coder_ms; }));
  const double decoder = median(column(all_arrivals.decoded, [](const Arrival& a) { return a.ms; }));
  const double receiver_first = arrivals[arrivals.size() / 10].memory_mb, receiver_last = arrivals.back().memory_mb;
  std::printf("2 x %s at %g Hz for %g s, %.0f kB a pair, two processes on loopback, %s%s\n", options.size.c_str(),
              options.rate_hz, options.seconds, kilobytes, options.coding.c_str(), options.secured ? ", secured" : "");
  std::printf("the line adds   p50 %.2f ms, p99 %.2f ms, worst %.2f ms\n", p50, p99, worst);
  std::printf("pairs           %llu sent, %lld lost\n", static_cast<unsigned long long>(sent.pairs), lost);
  std::printf("coder           %.1f ms a pair to code, %.1f ms to decode\n", coder, decoder);
  std::printf("age on arrival  p50 %.1f ms in the first fifth, %.1f ms in the last\n", age(0, 0.2), age(0.8, 1));
  std::printf("memory          sender %.1f to %.1f MB, receiver %.1f to %.1f MB\n", sent.memory_mb_first,
              sent.memory_mb_last, receiver_first, receiver_last);
  if (const std::string trouble = link::receive_buffer_trouble(); !trouble.empty())
    std::fprintf(stderr, "bench: %s\n", trouble.c_str());
  const nlohmann::json all = {{"added_p50_ms", p50},
                              {"added_p99_ms", p99},
                              {"added_worst_ms", worst},
                              {"pairs_sent", sent.pairs},
                              {"pairs_lost", lost},
                              {"pair_kb", kilobytes},
                              {"coder_ms", coder},
                              {"decoder_ms", decoder},
                              {"age_first_ms", age(0, 0.2)},
                              {"age_last_ms", age(0.8, 1)},
                              {"sender_growth_mb", sent.memory_mb_last - sent.memory_mb_first},
                              {"receiver_growth_mb", receiver_last - receiver_first}};
  write_numbers(options.json, all.dump(2));
  return p50 <= 1 && p99 <= 5 && lost == 0 ? 0 : 1;
}

}  // namespace foresight
