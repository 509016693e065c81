#include "apps/bench/bench_command.hpp"

#include <memory>

#include "apps/bench/figures.hpp"

namespace foresight {
namespace {

void add_figures(CLI::App& bench, std::function<int()>& action) {
  auto* command = bench.add_subcommand("figures", "Draws what each step of the thesis' pipeline does");
  auto options = std::make_shared<FigureOptions>();
  command->add_option("RUN", options->run, "A run, best one of `foresight synth --no-distortion`")->required();
  command->add_option("--out", options->out, "Folder for the pictures")->required();
  command->callback([options, &action] { action = [options] { return draw_figures(*options); }; });
}

}  // namespace

void add_bench_command(CLI::App& app, std::function<int()>& action) {
  auto* bench = app.add_subcommand("bench", "Measures, and compares with the pipeline of the thesis");
  bench->require_subcommand(1);
  add_figures(*bench, action);
}

}  // namespace foresight
