#include "apps/export.hpp"

#include <algorithm>
#include <chrono>
#include <iostream>

#include "apps/replay_report/progress_bar.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "display/recorded_source.hpp"
#include "display/view_session.hpp"
#include "pictures/encode.hpp"
#include "texture_gpu/gltf_scene.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;

/// The files of one export.
struct Outputs {
  fs::path model;
  fs::path bin, png;  // empty for .glb, which holds them
};

Outputs files_of(const fs::path& out) {
  const std::string extension = lower(out.extension().string());
  if (extension == ".glb") return {out, {}, {}};
  if (extension != ".gltf")
    throw InputError(
        "--out " + out.string(),
        extension.empty() ? "has no extension" : in_quotes(extension) + " is not a form that can be written",
        "name the file .glb or .gltf");
  Outputs all{out, out, out};
  all.bin.replace_extension(".bin");
  all.png.replace_extension(".png");
  return all;
}

std::size_t image_count(const RunFolder& run, const ExportOptions& options) {
  const std::size_t count = run.frames().size();
  if (!options.until_frame) return count;
  const auto wanted = static_cast<std::size_t>(*options.until_frame) + 1;
  if (wanted > count)
    throw InputError("--until-frame " + std::to_string(*options.until_frame),
                     "the run has only " + std::to_string(count) + " images",
                     "give at most " + std::to_string(count - 1));
  return wanted;
}

/// False: stopped by Ctrl-C.
bool extract(ViewSession& session, const RunFolder& run, std::size_t count, double margin_px) {
  const auto now = [] { return std::chrono::steady_clock::now(); };
  ProgressBar bar("export", "images", count, now(), ProgressBar::for_stderr());
  ChartAtlas::Policy policy;
  for (std::size_t i = 0; i < count; ++i) {
    if (stop_requested()) return false;
    policy = session.process(load_posed_frame(run, i, margin_px)).policy;
    std::cerr << bar.update(i + 1, now()) << std::flush;
  }
  std::cerr << bar.finish(count, now());
  if (policy.evicted_pages || policy.steps_down)
    std::printf(
        "The texture budget was reached, so some surfaces are coarser or forgotten; give more with "
        "--texture-memory-mb.\n");
  return true;
}

std::string as_png(const cv::Mat& picture) {
  const std::vector<std::uint8_t> bytes = encode_png(picture);
  return {bytes.begin(), bytes.end()};
}

void write(const GltfModel& model, const Outputs& outputs) {
  if (outputs.bin.empty()) return write_file_atomically(outputs.model, to_glb(model));
  const GltfFiles files = to_gltf(model, outputs.bin.filename().string(), outputs.png.filename().string());
  const FileContent all[] = {{outputs.png, model.png}, {outputs.bin, files.bin}, {outputs.model, files.gltf}};
  write_files_atomically(all);
}

}  // namespace

std::vector<Output> export_outputs(const fs::path& out) {
  const Outputs files = files_of(out);
  std::vector<Output> all{{files.model, Output::Kind::file, model_form()}};
  for (const fs::path& part : {files.bin, files.png})
    if (!part.empty()) all.push_back({part, Output::Kind::file, part_form(files.model, model_form())});
  return all;
}

int export_model(const ExportOptions& given) {
  const Outputs outputs = files_of(given.out);
  ExportOptions options = given;
  const RunFolder run = open_run(options);
  const std::size_t count = image_count(run, options);
  check_images(run);
  poll_stop_signals();

  const auto context = gl::create_headless_context();
  ViewSetup setup = view_setup(run, options.textures);
  setup.newest_image = false;  // textures are all that is wanted
  ViewSession session(*context, setup);
  if (!extract(session, run, count, options.textures.margin_px)) {
    std::cerr << "\nforesight: stopped by " << stopped_by() << ", nothing was written\n";
    return kStopped;
  }
  const TextureLease lease = session.textures();
  const BakedAtlas atlas = bake_atlas(TextureReadback(*lease, session.surface()), options.max_atlas);
  GltfModel model;
  model.generator = "Foresight " FORESIGHT_VERSION;
  model.nodes = gltf_nodes(*run.scene(), run.state_at(run.frames()[count - 1].left.time), *session.surface(), atlas);
  model.png = as_png(atlas.colours);
  write(model, outputs);
  std::printf("%zu triangles, %zu nodes, textures of %zu images in %d x %d px\n", run.scene()->triangle_count(),
              model.nodes.size(), count, atlas.colours.cols, atlas.colours.rows);
  if (atlas.scale < 1)
    std::printf("The textures were scaled by %.2f to fit; give more with --max-atlas.\n", atlas.scale);
  std::printf("%s\n", outputs.model.c_str());
  return 0;
}

}  // namespace foresight
