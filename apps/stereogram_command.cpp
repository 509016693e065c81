#include "apps/stereogram_command.hpp"

#include <cstdio>
#include <filesystem>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "apps/command_line/picture_size.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "display/stereogram/decode.hpp"
#include "display/stereogram/stereogram.hpp"
#include "gl/context.hpp"
#include "gl/raster_pass.hpp"
#include "gl/read_texture.hpp"
#include "pictures/encode.hpp"
#include "pictures/picture_file.hpp"
#include "rig_view/eye.hpp"
#include "scene/run_folder.hpp"
#include "scene/scene_reader.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

struct StereogramArguments {
  std::string input, out, size = "1024x768", pattern = "random";
  std::vector<double> cursor;
  std::optional<int> image;
  LookFrom from = LookFrom::iso;
  StereogramOptions options;
  int seed = 1, frame = 0;
  bool terraces = false, sees_through = false;
};

cv::Size stereogram_size(const std::string& text) {
  const auto [width, height] = size_option(text, {64, 16}, {8192, 8192});
  return {width, height};
}

void check_depth(const StereogramDepth& depth, cv::Size size) {
  const double least = depth.separation(depth.inverted ? 0 : 1);
  if (least < Stereogram::kLeastSeparation)
    throw InputError(
        "--eye-distance", "the pattern would repeat after " + std::to_string(static_cast<int>(least)) + " px",
        "give at least " +
            std::to_string(static_cast<int>(depth.eye_distance * Stereogram::kLeastSeparation / least) + 1));
  if (depth.separation(depth.inverted ? 1 : 0) > size.width / 2)
    throw InputError("--eye-distance",
                     "the pattern would not repeat once in a picture " + std::to_string(size.width) + " px wide",
                     "give at most " + std::to_string(size.width) + ", or a wider --size");
}

/// The input, and where it is looked at from.
struct Seen {
  std::shared_ptr<const SceneModel> scene;
  SceneState state;
  Pose T_world_camera = Pose::Identity();
  Lens lens;
};

/// A pinhole that sees as much across as `across` rad.
Lens pinhole(cv::Size size, double across) {
  Lens::Parameters p;
  p.width = size.width;
  p.height = size.height;
  p.fx = p.fy = 0.5 * size.width / std::tan(0.5 * across);
  p.cx = 0.5 * (size.width - 1);
  p.cy = 0.5 * (size.height - 1);
  return Lens(p);
}

Seen see_run(const StereogramArguments& a, cv::Size size) {
  const RunFolder run = RunFolder::open(a.input, {});
  const int count = static_cast<int>(run.frames().size()), index = a.image.value_or(count - 1);
  if (index < 0 || index >= count)
    throw InputError("--image", "the run has no image " + std::to_string(index),
                     "give 0 to " + std::to_string(count - 1));
  const RunImage& image = run.frames()[static_cast<std::size_t>(index)].left;
  const Lens& lens = run.lens_left();
  return {run.scene(), run.state_at(image.time), image.T_world_camera,
          pinhole(size, 2 * std::atan(0.5 * lens.width() / lens.parameters().fx))};
}

Seen see_model(const StereogramArguments& a, cv::Size size) {
  const fs::path file = a.input;
  if (a.image) throw InputError("--image", "belongs to a run, and " + a.input + " is a model", "leave it out");
  Seen out;
  out.scene = std::make_shared<const SceneModel>(read_scene(file, file.parent_path()));
  out.state = {RobotTime{}, StateStatus::exact, out.scene->rest_poses()};
  Eigen::AlignedBox3d box;
  for (std::size_t i = 0; i < out.scene->nodes().size(); ++i)
    for (const auto& p : out.scene->nodes()[i].mesh.vertices) box.extend(out.state.T_world_node[i] * p.cast<double>());
  if (box.isEmpty()) throw InputError(a.input, "has no surface", "give a model with triangles");
  const double across = 0.6;
  Eye eye = Eye::from(a.from, box, size.width / static_cast<double>(size.height));
  // Far enough for the whole box through this lens, whatever Eye's own is.
  eye.distance = 0.5 * box.diagonal().norm() /
                 std::sin(0.5 * across * std::min(1.0, size.height / static_cast<double>(size.width)));
  out.T_world_camera = eye.T_world_eye();
  out.lens = pinhole(size, across);
  return out;
}

cv::Mat inverse_distance(const gl::Texture& depth) {
  return gl::read_texture(depth) / gl::kNearPlane;
}

/// A ring with a dot in its middle.
cv::Mat cursor_picture() {
  cv::Mat out(25, 25, CV_8UC4, cv::Scalar(40, 220, 255, 0));
  const cv::Scalar dark(0, 0, 0, 255), bright(40, 220, 255, 255);
  cv::circle(out, {12, 12}, 10, dark, 4);
  cv::circle(out, {12, 12}, 10, bright, 2);
  cv::circle(out, {12, 12}, 2, bright, cv::FILLED);
  return out;
}

int run(const StereogramArguments& a) {
  const cv::Size size = stereogram_size(a.size);
  StereogramOptions options = a.options;
  options.seed = static_cast<unsigned>(a.seed);
  options.frame = static_cast<unsigned>(a.frame);
  options.smooth = !a.terraces;
  options.hides = !a.sees_through;
  check_depth(options.depth, size);
  const std::string ending = fs::path(a.out).extension().string();
  if (ending != ".png" && ending != ".jpg")
    throw InputError("--out " + a.out, "is no name of a picture", "end it in .png or .jpg");
  const cv::Mat pattern = a.pattern == "random" ? cv::Mat() : read_picture(a.pattern, PictureColours::colour);
  if (!pattern.empty() && (pattern.cols < 8 || pattern.rows < 8 || pattern.cols > 8192 || pattern.rows > 8192))
    throw InputError(a.pattern, "is too small or too large for a pattern", "give a picture of 8 to 8192 px each way");
  const Seen seen = fs::is_directory(a.input) ? see_run(a, size) : see_model(a, size);

  const auto context = gl::create_headless_context();
  gl::set_up_context();
  const gl::FaceImages faces(gl::faces_for(seen.lens, 0), false);
  gl::RasterPass(std::make_shared<gl::SceneBuffers>(*seen.scene), false)(seen.T_world_camera, seen.state, faces);
  const cv::Mat inverse = inverse_distance(faces.depth);
  const DepthRange range = depth_range(inverse);
  if (!(range.far > 0)) throw InputError(a.input, "nothing of its model is seen from there", "look from elsewhere");
  Stereogram stereogram(size.width, size.height, pattern);
  stereogram(faces.depth, range, options);
  const cv::Mat decoded = decode_stereogram(stereogram.read(), options.depth.least(), options.depth.most());
  if (!a.cursor.empty())
    stereogram.float_over({cursor_picture(), a.cursor[0], a.cursor[1], a.cursor.size() > 2 ? a.cursor[2] : 1.0});
  const cv::Mat drawn = stereogram.read();
  gl::check_errors("stereogram");

  const std::vector<std::uint8_t> bytes = encode_for(ending, drawn, 95);
  write_file_atomically(a.out, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  std::printf(
      "%s: %.2f to %.2f m as separations of %.1f to %.1f px; %.1f %% of the surface can be read from it within 1 px\n",
      a.out.c_str(), range.near, range.far, options.depth.least(), options.depth.most(),
      1e2 * share_decoded(nearness(inverse, range), decoded, options.depth, 1));
  return 0;
}

}  // namespace

void add_stereogram_command(Command& app, std::function<int()>& action) {
  auto* command = app.add_subcommand(
      "stereogram", "Draws a run's scene or a model as a single-image stereogram (docs/stereograms.md)");
  auto a = std::make_shared<StereogramArguments>();
  command->add_option("INPUT", a->input, "Folder of a run, or a model: mesh file or scene.yaml")->reads()->required();
  command->add_option("--out", a->out, "The picture (.png or .jpg)")->writes(picture_form())->required();
  command->add_option("--size", a->size, "WIDTHxHEIGHT in px")->capture_default_str();
  command->add_option("--image", a->image, "Of a run: seen as in this image, counted from 0 (default: the last)")
      ->check(from_to(0, 1e6));
  command->add_choice(
      "--from", a->from,
      {{"front", LookFrom::front}, {"side", LookFrom::side}, {"top", LookFrom::top}, {"iso", LookFrom::iso}},
      "Of a model: from where (default iso)");
  command->add_option("--pattern", a->pattern, "A picture that repeats, or `random`: dots")
      ->reads()
      ->capture_default_str();
  command->add_option("--eye-distance", a->options.depth.eye_distance, "Of the viewer's eyes, in px of the picture")
      ->check(from_to(1, 8192))
      ->capture_default_str();
  command
      ->add_option("--depth", a->options.depth.depth_of_field,
                   "How deep it is: of the way from the farthest surface to the picture")
      ->check(from_to(0.01, 0.9))
      ->default_str("0.33");
  command->add_flag("--invert", a->options.depth.inverted, "For eyes that cross before the picture");
  command->add_flag("--terraces", a->terraces, "Whole pixels only, as stereograms were made at first");
  command->add_flag("--see-through", a->sees_through, "Does not cut what only one eye can see");
  command->add_choice<StripPictures>("--strips", a->options.pictures,
                                     {{"one", StripPictures::one}, {"two", StripPictures::two}},
                                     "Strips in one picture, or in two in turn: the same result (default one)");
  command->add_option("--dot", a->options.dot, "Side of a random dot, px")
      ->check(from_to(1, 16))
      ->capture_default_str();
  command->add_option("--seed", a->seed, "Of the dots")->check(from_to(0, 1e9))->capture_default_str();
  command->add_option("--frame", a->frame, "Of an animation: each has other dots, or the pattern moved")
      ->check(from_to(0, 1e9))
      ->capture_default_str();
  command->add_option("--cursor", a->cursor, "X Y [NEARNESS]: a ring that floats there, 0 (far) to 1 (near)")
      ->expected(2, 3)
      ->check(from_to(0, 8192));
  command->footer(
      "Look through the picture, as if at something twice as far away, until two neighbours of the pattern meet.\n\n"
      "Exit codes: 0 done, 1 no OpenGL, 2 wrong input.\n\n"
      "Example: foresight stereogram runs/bench --out dots.png --eye-distance 240");
  command->callback([a, &action] { action = [a] { return run(*a); }; });
}

}  // namespace foresight
