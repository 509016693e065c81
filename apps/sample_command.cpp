#include "apps/sample_command.hpp"

#include <charconv>
#include <csignal>
#include <cstdio>
#include <memory>

#include "apps/replay_report/progress_bar.hpp"
#include "common/error.hpp"
#include "sim/sample_run.hpp"

namespace foresight {
namespace {

struct Arguments {
  std::string out;
  std::string size = "640x480";
  sim::SampleRunOptions options;
};

volatile std::sig_atomic_t interrupted = 0;
struct Interrupted {};

void parse_size(const std::string& text, sim::SampleRunOptions& options) {
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, options.width);
  const bool separated = width.ec == std::errc() && width.ptr != end && *width.ptr == 'x';
  const auto height = separated ? std::from_chars(width.ptr + 1, end, options.height) : width;
  if (!separated || height.ec != std::errc() || height.ptr != end)
    throw InputError("--size", "'" + text + "' is not a size", "write it as WIDTHxHEIGHT, such as 640x480");
}

int run(Arguments arguments) {
  parse_size(arguments.size, arguments.options);
  std::signal(SIGINT, [](int) { interrupted = 1; });
  const std::size_t images = static_cast<std::size_t>(arguments.options.frames) * (arguments.options.stereo ? 2 : 1);
  const auto now = [] { return std::chrono::steady_clock::now(); };
  std::fputs("sample: lighting the lab\n", stderr);
  ProgressBar bar("sample", "images", images, now(), ProgressBar::for_stderr());
  try {
    sim::write_sample_run(arguments.out, arguments.options, [&](int done, int) {
      if (interrupted) throw Interrupted();
      std::fputs(bar.update(static_cast<std::size_t>(done), now()).c_str(), stderr);
    });
  } catch (const Interrupted&) {
    std::fputs("\nforesight: stopped by Ctrl-C, nothing was written\n", stderr);
    return 130;
  }
  std::fputs(bar.finish(images, now()).c_str(), stderr);
  std::printf("%s\n", arguments.out.c_str());
  return 0;
}

}  // namespace

void add_sample_command(CLI::App& app, std::function<int()>& action) {
  CLI::App* command =
      app.add_subcommand("sample", "Write the built-in sample run: a small lab, rendered with exact truth");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("OUT", arguments->out, "Folder to write; an earlier sample run in it is replaced")->required();
  command->add_option("--frames", arguments->options.frames, "Images per camera, 30 per second")->capture_default_str();
  command->add_option("--size", arguments->size, "Image size in pixels, WIDTHxHEIGHT")->capture_default_str();
  command->add_flag("--stereo", arguments->options.stereo, "Add a second camera, 65 mm to the right");
  command->add_flag("!--no-distortion", arguments->options.distortion, "An ideal pinhole instead of a real lens");
  command->add_flag("--fisheye", arguments->options.fisheye, "An equidistant lens of 150 degrees");
  command->add_option("--seed", arguments->options.seed, "Varies wood grain and small print")->capture_default_str();
  command->callback([arguments, &action] { action = [arguments] { return run(*arguments); }; });
}

}  // namespace foresight
