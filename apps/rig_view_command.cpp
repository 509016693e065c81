#include "apps/rig_view_command.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>

#include "apps/command_line/picture_size.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/split.hpp"
#include "common/text.hpp"
#include "gl/context.hpp"
#include "pictures/encode.hpp"
#include "rig_view/rig_picture.hpp"
#include "rig_view/rig_window.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

struct RigViewArguments {
  std::string rig, joints, scene, out, size = "1320x860";
  std::vector<std::string> hide;
  std::optional<LookFrom> from;
  double zoom = 1;
};

cv::Size picture_size(const std::string& text) {
  const auto [width, height] = size_option(text, {2 * kPanelWidth, 400}, {8000, 8000});
  return {width, height};
}

/// Between blanks, as the command line has them, or commas, as --joints has.
std::vector<std::string> words_of(const std::vector<std::string>& given) {
  std::vector<std::string> out;
  for (const std::string& list : given)
    for (const std::string& word : split(list, ','))
      if (!word.empty()) out.push_back(word);
  return out;
}

Layers layers_without(const std::vector<std::string>& hidden) {
  static const std::vector<std::string> words = {"links",  "guards", "obstacles", "workspace",
                                                 "limits", "frames", "cameras",   "names"};
  Layers out = kAllLayers;
  for (const std::string& word : words_of(hidden)) {
    const auto at = static_cast<std::size_t>(std::ranges::find(words, word) - words.begin());
    if (at == words.size())
      throw InputError("--hide", in_quotes(word) + " is nothing that a picture shows", did_you_mean(word, words));
    out[at] = false;
  }
  return out;
}

std::string ending_of(const fs::path& out) {
  const std::string ending = out.extension().string();
  if (ending != ".png" && ending != ".jpg")
    throw InputError("--out " + out.string(), "is no name of a picture", "end it in .png or .jpg");
  return ending;
}

int write_picture(RigBody& body, const RigViewArguments& arguments, const std::vector<double>& positions) {
  const cv::Size size = picture_size(arguments.size);
  const std::string ending = ending_of(arguments.out);
  const auto context = gl::create_headless_context();
  gl::set_up_context();
  RigPicture picture(body);
  PanelState state;
  state.title = body.rig().name;
  state.positions = positions;
  state.layers = layers_without(arguments.hide);
  state.about_cameras = body.about_cameras();
  const double proportions = (size.width - kPanelWidth) / static_cast<double>(size.height);
  Eye eye = Eye::from(arguments.from.value_or(LookFrom::iso), body.extent(), proportions);
  eye.distance /= arguments.zoom;
  const PlacedRig placed = body.at(positions);
  const cv::Mat drawn = picture(body, placed, state, eye, size.width, size.height);
  gl::check_errors("rig view");
  const std::vector<std::uint8_t> bytes = encode_for(ending, drawn, 86);
  write_file_atomically(arguments.out, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  for (const NearCouple& couple : placed.couples)
    if (couple.margin_m < 0) std::fprintf(stderr, "rig view: %s\n", couple.text.c_str());
  std::printf("%s\n", arguments.out.c_str());
  return 0;
}

int run(const RigViewArguments& arguments) {
  const Rig rig = read_rig(arguments.rig);
  RigBody body(rig, arguments.scene.empty() ? std::nullopt : std::optional<fs::path>(arguments.scene));
  std::vector<double> positions = body.rest();
  set_positions(rig, arguments.joints, "--joints", positions);
  if (!arguments.out.empty()) return write_picture(body, arguments, positions);
  if (arguments.from || !arguments.hide.empty())
    throw InputError("--from, --hide", "belong to --out", "add --out, or use the window's keys");
  RigWindow window(body, {"Foresight rig: " + rig.name, positions});
  window.run([] { return false; });
  return 0;
}

}  // namespace

void add_rig_view_command(Command& rig, std::function<int()>& action) {
  auto* command = rig.add_subcommand("view", "Shows a rig in three dimensions: what the gate guards, limits, cameras");
  auto a = std::make_shared<RigViewArguments>();
  command->add_option("RIG", a->rig, "Rig file (docs/rig-files.md)")->reads()->required();
  command->add_option("--joints", a->joints, "Where joints stand: NAME=VALUE,... in rad or m; the others at rest");
  command->add_option("--scene", a->scene, "What stands around, in place of the rig's `scene:`")->reads();
  command->add_option("--out", a->out, "Writes a picture (.png or .jpg) instead of opening a window")
      ->writes(picture_form());
  command->add_choice<std::optional<LookFrom>>(
      "--from", a->from,
      {{"front", LookFrom::front}, {"side", LookFrom::side}, {"top", LookFrom::top}, {"iso", LookFrom::iso}},
      "With --out: from where; front (+x), side (-y) and top without perspective (default iso)");
  command->add_option("--zoom", a->zoom, "With --out: nearer by this factor; below 1 shows more around")
      ->check(from_to(0.05, 20))
      ->capture_default_str();
  command->add_option("--size", a->size, "With --out: WIDTHxHEIGHT in px")->capture_default_str();
  command
      ->add_option("--hide", a->hide, "With --out: any of links,guards,obstacles,workspace,limits,frames,cameras,names")
      ->expected(1, static_cast<int>(kLayers));
  command->footer(
      "In the window the mouse turns the view and pulls sliders; keys are written in it. While a robot runs:\n"
      "`foresight robot RIG --rig-view`.\n\n"
      "Exit codes: 0 done, 1 no OpenGL or no desktop, 2 wrong input.\n\n"
      "Example: foresight rig view configs/minerva.yaml --joints elbow=0.7,pan=0.2 --out minerva.png --from side");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
