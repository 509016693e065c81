#include "apps/bench/bench_command.hpp"

#include <memory>

#include "apps/bench/calibration_bench.hpp"
#include "apps/bench/camera_bench.hpp"
#include "apps/bench/can_bench.hpp"
#include "apps/bench/display_bench.hpp"
#include "apps/bench/extraction.hpp"
#include "apps/bench/figures.hpp"
#include "apps/bench/head_bench.hpp"
#include "apps/bench/line_bench.hpp"
#include "apps/bench/link_bench.hpp"
#include "apps/bench/margin.hpp"
#include "apps/bench/prediction_bench.hpp"
#include "apps/bench/registration_bench.hpp"
#include "apps/bench/robot_bench.hpp"
#include "apps/bench/seat_bench.hpp"
#include "apps/bench/shadow_bench.hpp"
#include "apps/bench/view_bench.hpp"
#include "apps/run_options.hpp"

namespace foresight {
namespace {

std::vector<Output> plot_outputs(const std::filesystem::path& plot) {
  std::vector<Output> all = page_outputs(plot);
  all.front().form = svg_form();
  return all;
}

void add_figures(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("figures", "Draws what each step of the thesis' pipeline does");
  auto options = std::make_shared<FigureOptions>();
  command->add_option("RUN", options->run, "A run, best one of `foresight synth --no-distortion`")->reads()->required();
  command->add_option("--out", options->out, "Folder for the pictures")->writes(figure_outputs)->required();
  command->callback([options, &action] { action = [options] { return draw_figures(*options); }; });
}

void add_extraction(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("extraction", "CPU time of the core and of the thesis' pipeline");
  auto options = std::make_shared<ExtractionBenchOptions>();
  command->add_option("RUN", options->run, "A run; the thesis' own scale: `foresight synth RUN --no-distortion`")
      ->reads()
      ->required();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->add_option("--images", options->images, "Take only the first so many images")->check(from_to(4, 1000000));
  command->add_flag("!--no-tables", options->tables, "Only the comparison, without tables 7.1 to 7.4");
  command->footer("Example: foresight synth lab --no-distortion && foresight bench extraction lab --json bench.json");
  command->callback([options, &action] { action = [options] { return bench_extraction(*options); }; });
}

void add_margin(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("margin", "Counts what registration errors paint wrong, by truth");
  auto options = std::make_shared<MarginBenchOptions>();
  command->add_option("RUN", options->run, "A run of `foresight synth --no-distortion`, with truth")
      ->reads()
      ->required();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->add_option("--plot", options->plot, "SVG file; its series go to FILE.plots.json beside it")
      ->writes(plot_outputs);
  command->add_option("--images", options->images, "Images of the run, evenly spread")
      ->check(from_to(1, 1024))
      ->capture_default_str();
  command->callback([options, &action] { action = [options] { return bench_margin(*options); }; });
}

void add_can(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("can", "CPU time of our share of CAN beside what a wire can carry");
  auto options = std::make_shared<CanBenchOptions>();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer("Exit code: 1 where a full 1 Mbit/s bus needs 5 % of a core or more.");
  command->callback([options, &action] { action = [options] { return bench_can(*options); }; });
}

void add_robot(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("robot", "Punctuality and CPU time of the control loop, with emulated drives");
  auto options = std::make_shared<RobotBenchOptions>();
  command->add_option("RIG", options->rig, "Rig file; its buses are taken as mock ones")->reads()->required();
  command->add_option("--seconds", options->seconds, "How long")->check(from_to(1.0, 86400.0))->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer("Exit code: 1 where the robot did not follow to the end.");
  command->callback([options, &action] { action = [options] { return bench_robot(*options); }; });
}

void add_link(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("link", "What the line adds to a pair's age on loopback, between two processes");
  auto options = std::make_shared<LinkBenchOptions>();
  command->add_option("--seconds", options->seconds, "How long")->check(from_to(1, 86400))->capture_default_str();
  command->add_option("--size", options->size, "Of each picture, px")->capture_default_str();
  command->add_option("--rate", options->rate_hz, "Pairs a second")->check(from_to(0.1, 1000))->capture_default_str();
  command->add_option("--coding", options->coding, "Of the pictures")
      ->check(one_of({"jpeg", "h264"}))
      ->capture_default_str();
  command->add_option("--quality", options->quality, "Of JPEGs")->check(from_to(1, 100))->capture_default_str();
  command->add_flag("--secured", options->secured, "Encrypted and authenticated, with keys made for it");
  command->add_option("--domain", options->domain, "DDS domain to use")->check(from_to(0, 230))->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer("Exit code: 1 where it adds more than 1 ms (p50) or 5 ms (p99), or loses a pair.");
  command->callback([options, &action] { action = [options] { return bench_link(*options); }; });
}

void add_calibration(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("calibration", "CPU time and held-out error of our stereo solver and OpenCV's");
  auto options = std::make_shared<CalibrationBenchOptions>();
  command->add_option("CORNERS", options->corners, "Corners of a pair: .vnl, or a folder with cam0/ and cam1/")
      ->reads()
      ->required();
  command->add_option("--board", options->board, "As in `foresight calibrate stereo`");
  command->add_option("--size", options->size, "WIDTHxHEIGHT of the images")->capture_default_str();
  command->add_option("--images", options->images, "Folder or pattern: measures finding the corners in them too")
      ->reads();
  command->add_option("--runs", options->runs, "Of which the median counts")
      ->check(from_to(1, 100))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight bench calibration corners.vnl --board chessboard:9x6:0.025 --images 'left*.jpg'\n"
      "Exit code: 1 where OpenCV predicts the views left out better.");
  command->callback([options, &action] { action = [options] { return bench_calibration(*options); }; });
}

void add_registration(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("registration", "CPU time and error of the registration of a stereo pair");
  auto options = std::make_shared<RegistrationBenchOptions>();
  command->add_option("--pairs", options->pairs, "How many")->check(from_to(2, 1000))->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer("Example: foresight bench registration --pairs 40");
  command->callback([options, &action] { action = [options] { return bench_registration(*options); }; });
}

void add_camera(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("camera", "CPU time of the mock cameras, rendering and all else apart");
  auto options = std::make_shared<CameraBenchOptions>();
  command->add_option("--width", options->width, "Pixels")->check(from_to(16, 4096))->capture_default_str();
  command->add_option("--height", options->height, "Pixels")->check(from_to(16, 4096))->capture_default_str();
  command->add_option("--rate", options->rate, "Pairs per second")->check(from_to(1, 240))->capture_default_str();
  command->add_option("--seconds", options->seconds, "Of each round")->check(from_to(1, 60))->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer("Exit code: 1 where all that is not rendering takes a tenth of a core or more.");
  command->callback([options, &action] { action = [options] { return bench_camera(*options); }; });
}

void add_head(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("head", "What warping a drawn view to where the head is now costs and shows");
  auto options = std::make_shared<HeadBenchOptions>();
  command->add_option("RUN", options->run, "A run, whose images give the textures (default: a synthetic lab)")->reads();
  command->add_option("--width", options->width, "Pixels of an eye")->check(from_to(16, 4096))->capture_default_str();
  command->add_option("--height", options->height, "Pixels")->check(from_to(16, 4096))->capture_default_str();
  command->add_option("--views", options->views, "So many motions")->check(from_to(1, 10000))->capture_default_str();
  command->add_option("--degrees", options->degrees, "Of each")->check(from_to(0.0, 20.0))->capture_default_str();
  command->add_option("--metres", options->metres, "Of each")->check(from_to(0.0, 1.0))->capture_default_str();
  command->add_option("--seed", options->seed, "Another seed, other motions");
  command->add_option("--path", options->path, "A recorded head, as bench prediction head takes it (default: it sways)")
      ->reads();
  command->add_option("--head-frames", options->head_frames, "So many frames of it with views in all directions")
      ->check(from_to(1, 100'000))
      ->capture_default_str();
  command->add_option("--only", options->only, "These parts alone")->check(one_of(kHeadBenchParts));
  command->add_option("--picture", options->picture, "PNG file: the workshop in full, within 120 ms, and its levels")
      ->writes(png_form());
  command
      ->add_option("--building", options->building,
                   "Triangles of the building, and of the workshop, that drawing is measured in")
      ->check(from_to(100, 20'000'000))
      ->capture_default_str();
  command->add_option("--building-views", options->building_views, "So many views of it")
      ->check(from_to(1, 1'000'000))
      ->capture_default_str();
  command
      ->add_option("--openxr-frames", options->openxr_frames,
                   "Frames shown in the OpenXR runtime of this machine; 0: none")
      ->check(from_to(0, 100'000'000))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "Of each trial in real time; 0: none")
      ->check(from_to(0.0, 3600.0))
      ->capture_default_str();
  command
      ->add_option("--rate", options->rate_hz, "Stereo frames a second of them; of half the size, 2.25 times as many")
      ->check(from_to(1.0, 240.0))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer("Example: foresight bench head --path head.csv --json head.json");
  command->callback([options, &action] { action = [options] { return bench_head(*options); }; });
}

void add_display(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("display", "How punctual frames are beside the extraction, and what it is left");
  auto options = std::make_shared<DisplayBenchOptions>();
  command->add_option("--size", options->size, "WIDTHxHEIGHT of the view, px")->capture_default_str();
  command->add_option("--seconds", options->seconds, "Of each round")->check(from_to(0.2, 3600))->capture_default_str();
  command
      ->add_option("--long-seconds", options->long_seconds, "Of the round beside the extraction at 25 frames a second")
      ->check(from_to(0.2, 3600));
  command->add_option("--rate", options->rate_hz, "Frames a second: this alone, in place of 25, 33, 50 and 100")
      ->check(from_to(1, 240));
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight bench display --seconds 20 --json display.json\n"
      "Exit code: 1 where a bar of docs/performance.md is missed at 25 frames a second.");
  command->callback([options, &action] { action = [options] { return bench_display(*options); }; });
}

void add_line(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("line", "Age and quality of the images that a line lets through");
  auto options = std::make_shared<LineBenchOptions>();
  command->add_option("--trace", options->trace, "Recorded line from the robot; CSV: both ways")->reads();
  command->add_option("--trace-down", options->trace_down, "Recorded line to the robot")->reads();
  command->add_option("--line", options->line, "Instead: a whole line, as docs/line.md says")->reads();
  command->add_option("--delay-ms", options->delay_ms, "Each way, besides a trace")
      ->check(from_to(0, 60'000))
      ->capture_default_str();
  command->add_option("--loss", options->loss, "Share of packets that are lost each way, besides a trace")
      ->check(from_to(0, 0.9))
      ->capture_default_str();
  command->add_option("--burst", options->burst, "How many of them in a row, on average")
      ->check(from_to(1, 1000))
      ->capture_default_str();
  command->add_option("--seconds", options->seconds, "Of the line's time")
      ->check(from_to(1, 86400))
      ->capture_default_str();
  command->add_option("--size", options->size, "WIDTHxHEIGHT of one eye's picture, px")->capture_default_str();
  command->add_option("--coding", options->coding, "Of the pictures")
      ->check(one_of({"h264", "jpeg"}))
      ->capture_default_str();
  command->add_option("--pictures", options->pictures, "Pairs of the lab that are rendered; they play forth and back")
      ->check(from_to(2, 1000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of losses")->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Example: foresight bench line --trace drive.up --trace-down drive.down --json line.json\n"
      "Exit code: 1 where no picture was shown, one was damaged, or a pair was handed over too early.");
  command->callback([options, &action] { action = [options] { return bench_line(*options); }; });
}

void add_seat(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("seat", "A seat over a bad line for long, with faults on both sides");
  auto options = std::make_shared<SeatBenchOptions>();
  command->add_option("RIG", options->rig, "Rig file; its drives and cameras are made up")->reads()->required();
  command->add_option("--line", options->line, "File of a line, or a recorded trace")->reads();
  command->add_option("--seconds", options->seconds, "Of motion")->check(from_to(1, 86400))->capture_default_str();
  command->add_option("--delay-ms", options->delay_ms, "Each way, besides")
      ->check(from_to(0, 1e4))
      ->capture_default_str();
  command->add_option("--image-hz", options->image_hz, "Pairs of images a second")
      ->check(from_to(0.5, 60))
      ->capture_default_str();
  command->add_option("--pictures-hz", options->pictures_hz, "Pictures that are drawn a second")
      ->check(from_to(0.5, 60))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Of faults, motion and losses")->capture_default_str();
  command->add_option("--fault", options->fault, "Only faults with this in their names");
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "Both sides run in this program, in stepped time.\n"
      "Example: foresight bench seat configs/minerva.yaml --line TMobile-LTE-short.up --seconds 1800\n"
      "Exit code: 1 where a set-point was unsafe, the display stood still, a fault was not named, or memory grew.");
  command->callback([options, &action] { action = [options] { return bench_seat(*options); }; });
}

void add_shadow(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("shadow", "Errors in shadows of what moves, with these foretold and without");
  auto options = std::make_shared<ShadowBenchOptions>();
  command->add_option("RUN", options->runs, "Synthetic runs")->reads()->required();
  command->add_option("--delay-ms", options->delay_ms, "Age of the newest image")
      ->check(from_to(0.0, 1e5))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->footer(
      "A pixel counts where what stands still is behind something that moves, seen from the lab's lamp, when the "
      "newest\n"
      "image was taken or at the instant shown.");
  command->callback([options, &action] { action = [options] { return bench_shadow(*options); }; });
}

void add_view(Command& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("view", "CPU time of drawing one predicted view");
  auto options = std::make_shared<ViewBenchOptions>();
  command->add_option("RUN", options->run, "A run")->reads()->required();
  command->add_option("--images", options->images, "Take only the first so many images; the later half is drawn")
      ->check(from_to(2, 1000000))
      ->capture_default_str();
  command->add_option("--ahead", options->ahead, "Draw what is seen so many images after the newest")
      ->check(from_to(1, 1000000))
      ->capture_default_str();
  command->add_option("--rounds", options->rounds, "Drawings of each view, of which the median counts")
      ->check(from_to(1, 1000))
      ->capture_default_str();
  command->add_option("--json", options->json, "File for all numbers")->writes(numbers_form());
  command->callback([options, &action] { action = [options] { return bench_view(*options); }; });
}

}  // namespace

void add_bench_command(Command& app, std::function<int()>& action) {
  auto* bench = app.add_subcommand("bench", "Measures, and compares with the pipeline of the thesis");
  bench->require_subcommand();
  add_calibration(*bench, action);
  add_camera(*bench, action);
  add_can(*bench, action);
  add_display(*bench, action);
  add_extraction(*bench, action);
  add_figures(*bench, action);
  add_head(*bench, action);
  add_line(*bench, action);
  add_margin(*bench, action);
  add_prediction_benches(*bench, action);
  add_robot(*bench, action);
  add_link(*bench, action);
  add_registration(*bench, action);
  add_seat(*bench, action);
  add_shadow(*bench, action);
  add_view(*bench, action);
}

}  // namespace foresight
