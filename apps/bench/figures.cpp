#include "apps/bench/figures.hpp"

#include <array>
#include <cstdio>

#include "apps/bench/core_figure.hpp"
#include "apps/bench/mask_figures.hpp"
#include "apps/bench/view_figures.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "pictures/encode.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kFewestImages = 20;  // images
constexpr std::array kNames{"fig_4_08", "fig_4_15", "fig_4_20", "fig_5_09",
                            "fig_5_11", "fig_5_19", "fig_5_23", "core_vs_thesis"};

void check_run(const RunFolder& run) {
  const std::string where = run.root().string();
  if (!thesis::CameraFrame::can_undistort(run.lens_left()))
    throw InputError(where, "the lens sees more than one picture plane can hold, as the thesis' pipeline needs it",
                     "take a run with a lens of less than 120 degrees");
  if (run.frames().size() < kFewestImages)
    throw InputError(where, "holds only " + std::to_string(run.frames().size()) + " images",
                     "take a run of at least " + std::to_string(kFewestImages));
}

std::vector<FigurePage> draw_all(const RunFolder& run, const TextureOptions& core) {
  const auto say = [](const char* what) { std::fprintf(stderr, "figures: %s\n", what); };
  std::vector<FigurePage> pages;
  {
    const FigureLab lab(run);
    say("choosing the images");
    const FigurePair pair = choose_pair(lab);
    say("chapter 4");
    pages.push_back(occlusion_figure(lab, pair));
    BorderFigures borders = border_figures(lab, pair);
    pages.push_back(std::move(borders.without));
    pages.push_back(std::move(borders.with));
    say("chapter 5");
    ErrorFigures errors = error_figures(lab, pair);
    pages.push_back(std::move(errors.expansion));
    pages.push_back(mask_figure(lab, pair));
    pages.push_back(std::move(errors.filling));
    pages.push_back(filling_figure(lab, pair));
  }
  say("core and thesis");
  pages.push_back(core_figure(run, core));
  return pages;
}

void write(const std::vector<FigurePage>& pages, const fs::path& out) {
  std::vector<std::string> bytes;
  for (const FigurePage& page : pages) {
    const std::vector<std::uint8_t> png = encode_png(draw_page(page));
    bytes.emplace_back(png.begin(), png.end());
  }
  std::vector<FileContent> files;
  for (std::size_t i = 0; i < pages.size(); ++i) files.push_back({out / (std::string(kNames[i]) + ".png"), bytes[i]});
  write_files_atomically(files);
}

}  // namespace

std::vector<Output> figure_outputs(const fs::path& out) {
  std::vector<Output> all{{out, Output::Kind::folder}};
  for (const std::string name : kNames) all.push_back({out / (name + ".png"), Output::Kind::file, png_form()});
  return all;
}

int draw_figures(const FigureOptions& given) {
  FigureOptions options = given;
  const RunFolder run = open_run(options);
  check_run(run);
  check_images(run);
  write(draw_all(run, options.textures), options.out);
  std::printf("%s\n", options.out.c_str());
  return 0;
}

}  // namespace foresight
