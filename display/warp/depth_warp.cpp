#include "display/warp/depth_warp.hpp"

#include <algorithm>
#include <array>

#include "display/warp/warp_shaders.hpp"
#include "gl/lens_rays.hpp"

namespace foresight {
namespace {

constexpr int kMostRadius = 10;                           // blocks that surfaces may have moved by
constexpr std::size_t kMostMoved = 16, kWordsOfNode = 6;  // as in depth_warp.comp
constexpr double kMoved = 0.3;                            // px: less does not show
constexpr double kClosest = 0.05;                         // m: beyond that, a part reaches behind the camera
constexpr double kMargin = 1.02;                          // of depths
constexpr double kBend = 0.1;                             // of a box, through a lens with distortion
constexpr GLuint kRaysUnit = 7, kMendedBinding = 4;       // as in warp_rays.glsl, depth_warp.comp

Eigen::Vector4f numbers(const Lens& lens) {
  const auto& p = lens.parameters();
  return Eigen::Vector4d(p.fx, p.fy, p.cx, p.cy).cast<float>();
}

std::string define(const char* name, bool value) {
  return name + std::string(value ? " 1" : " 0");
}

Eigen::Vector2i tiles_of(const Lens& lens) {
  return {warp_blocks(lens.width()), warp_blocks(lens.height())};
}

constexpr std::array<GLuint, 3> kNoGroups{0, 1, 1};

std::size_t list_bytes(const Lens& target) {
  return sizeof(kNoGroups) + sizeof(GLuint) * static_cast<std::size_t>(tiles_of(target).prod());
}

/// Three rows of T_source_target, then the third of its inverse's rotation and its product with the translation.
std::array<Eigen::Vector4f, 4> rows_of(const Pose& T_source_target) {
  const Eigen::Matrix4f m = T_source_target.matrix().cast<float>();
  const Eigen::Vector3d back = T_source_target.linear().col(2);
  Eigen::Vector4d fourth;
  fourth << back, back.dot(T_source_target.translation());
  return {m.row(0).transpose(), m.row(1).transpose(), m.row(2).transpose(), fourth.cast<float>()};
}

/// A node that stands elsewhere than in the source.
struct Moved {
  std::size_t node = 0;
  Pose T_source_target = Pose::Identity();  // of points that go with it
  Eigen::AlignedBox2d rectangle;            // in the target, of where it is and was, px
  double nearest = 0, farthest = 0;         // m
};

/// Nothing where it did not move by so much that it shows, or is not seen.
std::optional<Moved> moved_node(const Eigen::AlignedBox3d& box, const Pose& T_camera_before, const Pose& T_camera_now,
                                const Lens& lens) {
  Moved out;
  out.nearest = 1e9;
  double farthest_moved = 0;
  bool behind = false;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d at = box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner));
    const Eigen::Vector3d before = T_camera_before * at, now = T_camera_now * at;
    out.nearest = std::min(out.nearest, std::max(now.z(), kClosest));
    out.farthest = std::max(out.farthest, now.z());
    const auto seen_before = lens.project(before), seen_now = lens.project(now);
    behind |= now.z() < kClosest || before.z() < kClosest || !seen_before || !seen_now;
    if (behind) continue;
    farthest_moved = std::max(farthest_moved, (*seen_now - *seen_before).norm());
    out.rectangle.extend(*seen_now);
    out.rectangle.extend(*seen_before);
  }
  if (out.farthest < kClosest) return std::nullopt;
  const Eigen::Vector2d size(lens.width(), lens.height());
  const Eigen::AlignedBox2d all(Eigen::Vector2d(0, 0), size);
  if (behind) {
    out.rectangle = all;
    return (T_camera_before.inverse() * T_camera_now).isApprox(Pose::Identity(), 1e-6) ? std::nullopt
                                                                                       : std::optional(out);
  }
  if (lens.has_distortion()) {  // straight edges bend
    const Eigen::Vector2d bend = kBend * out.rectangle.sizes();
    out.rectangle = {out.rectangle.min() - bend, out.rectangle.max() + bend};
  }
  if (farthest_moved < kMoved || !all.intersects(out.rectangle)) return std::nullopt;
  return out;
}

}  // namespace

DepthWarp::DepthWarp(std::shared_ptr<const WarpScene> scene, const Lens& target, bool tells)
    : scene_(std::move(scene)),
      target_(target),
      tells_(tells),
      distorted_(target.has_distortion()),
      rays_(gl::make_lens_rays(target)),
      tiles_(gl::Program::compute(gl::warp_shaders(), "tiles.comp", {define("DISTORTED", distorted_)})),
      mended_("count of holes that were mended"),
      lists_{{{GL_R32UI, list_bytes(target), "tiles of one surface"},
              {GL_R32UI, list_bytes(target), "tiles to be searched"},
              {GL_R32UI, list_bytes(target), "tiles of nodes that moved"}}},
      corners_(GL_RGBA32F, 16 * static_cast<std::size_t>(tiles_of(target).prod()), "depths of tiles of one surface"),
      slot_of_node_(GL_R8UI, 256, "nodes that moved"),
      moved_(GL_RGBA32F, 16, "how nodes moved"),
      picture_(GL_RGBA8, target.width(), target.height(), 0, 1, "warped picture"),
      holes_(GL_R8, tells ? target.width() : 1, tells ? target.height() : 1, 0, 1, "holes of the warped picture"),
      depth_(GL_R32F, tells ? target.width() : 1, tells ? target.height() : 1, 0, 1, "depth of the warped picture") {
  glTextureParameteri(rays_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(rays_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

gl::Program DepthWarp::warp_program(bool searched, bool moved, Writes what) const {
  return gl::Program::compute(gl::warp_shaders(), "depth_warp.comp",
                              {define("SEARCHED", searched), define("MOVED", moved), define("TELLS", tells_),
                               define("KEEPS", what == Writes::what_others_have_not),
                               define("MENDS", what == Writes::holes), define("DISTORTED", distorted_)});
}

int DepthWarp::find_moved(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node) {
  std::vector<Moved> all;
  const Pose T_camera_world = T_world_camera.inverse(), T_source_world = source.T_world_camera.inverse();
  const std::size_t nodes =
      std::min({T_world_node.size(), source.T_world_node.size(), scene_->boxes().size(), WarpScene::kMostNodes});
  for (std::size_t i = 0; i < nodes; ++i) {
    if (scene_->boxes()[i].isEmpty()) continue;
    // What the target would see of it where it stood, and what it sees.
    auto moved = moved_node(scene_->boxes()[i], T_camera_world * source.T_world_node[i],
                            T_camera_world * T_world_node[i], target_);
    if (!moved) continue;
    moved->node = i;
    moved->T_source_target = T_source_world * source.T_world_node[i] * T_world_node[i].inverse() * T_world_camera;
    all.push_back(*moved);
  }
  if (all.empty()) return 0;
  std::ranges::sort(all, {}, &Moved::nearest);
  all.resize(std::min(all.size(), kMostMoved));
  std::array<std::uint8_t, 256> slots{};
  std::vector<Eigen::Vector4f> words;
  words.reserve(kWordsOfNode * all.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const Moved& one = all[k];
    slots[one.node + 1] = static_cast<std::uint8_t>(k + 1);
    for (const Eigen::Vector4f& row : rows_of(one.T_source_target)) words.push_back(row);
    Eigen::Vector4d rectangle;
    rectangle << one.rectangle.min(), one.rectangle.max();
    words.push_back(rectangle.cast<float>());
    words.push_back(Eigen::Vector4d(kMargin / one.nearest, 1 / (kMargin * one.farthest), 0, 0).cast<float>());
  }
  slot_of_node_.assign(std::span<const std::uint8_t>(slots));
  moved_.assign(std::span<const Eigen::Vector4f>(words));
  return static_cast<int>(all.size());
}

void DepthWarp::spread(const WarpLayers& source, const Pose& T_source_target) {
  // What is half a metre away or farther moves by no more than this; what is nearer is found within half of it.
  constexpr double kNear = 0.5;  // m
  const double parallax = source.lens.parameters().fx * T_source_target.translation().norm() / kNear;
  reach_(source, std::clamp(static_cast<int>(parallax / kWarpBlock) + 1, 1, kMostRadius));
}

void DepthWarp::aim(const gl::Program& program, const WarpLayers& source, const Pose& T_source_target) const {
  const auto rows = rows_of(T_source_target);
  program.set("source_lens", numbers(source.lens));
  program.set("target_lens", numbers(target_));
  program.set("source_size", Eigen::Vector2i(source.lens.width(), source.lens.height()));
  program.set("target_size", Eigen::Vector2i(target_.width(), target_.height()));
  program.set("r0", rows[0]);
  program.set("r1", rows[1]);
  program.set("r2", rows[2]);
  program.set("back", rows[3]);
  program.set("of_part", static_cast<int>(source.of_part));
  if (distorted_) glBindTextureUnit(kRaysUnit, rays_.name());
}

void DepthWarp::list_tiles(const WarpLayers& source, const Pose& T_source_target, int moved, bool keeps) {
  const Eigen::Vector2i tiles = tiles_of(target_);
  aim(tiles_, source, T_source_target);
  tiles_.set("tiles", tiles);
  tiles_.set("moved_count", moved);
  tiles_.set("keeps", static_cast<int>(keeps));
  tiles_.set("of_part", static_cast<int>(keeps && source.of_part));
  glBindTextureUnit(0, source.blocks.name());
  glBindTextureUnit(1, reach_.last().name());
  glBindTextureUnit(2, moved_.texture());
  glBindTextureUnit(3, source.depth.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 3, corners_.buffer().name());
  for (GLuint i = 0; i < lists_.size(); ++i) {
    lists_[i].buffer().write(std::span<const GLuint>(kNoGroups));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, i, lists_[i].buffer().name());
  }
  tiles_.dispatch(tiles.x(), tiles.y());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
}

void DepthWarp::work_off(Tiles which, const gl::Program& program, const WarpLayers& source,
                         const Pose& T_source_target) const {
  const gl::BufferTexture& list = lists_[static_cast<std::size_t>(which)];
  aim(program, source, T_source_target);
  program.use();
  glBindTextureUnit(3, list.texture());
  glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, list.buffer().name());
  glDispatchComputeIndirect(0);
}

void DepthWarp::operator()(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node) {
  warp(source, T_world_camera, T_world_node, false);
}

void DepthWarp::clear() {
  constexpr GLubyte kBeyond = 255;
  glClearTexImage(picture_.name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glClearTexImage(holes_.name(), 0, GL_RED, GL_UNSIGNED_BYTE, &kBeyond);
  glClearTexImage(depth_.name(), 0, GL_RED, GL_FLOAT, nullptr);
}

void DepthWarp::add(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node) {
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  warp(source, T_world_camera, T_world_node, true);
}

void DepthWarp::bind(const WarpLayers& source) const {
  glBindTextureUnit(0, source.depth.name());
  glBindTextureUnit(1, source.picture.name());
  glBindTextureUnit(2, reach_.last().name());
}

void DepthWarp::bind_moved(const gl::Program& program, const WarpLayers& source, int moved) const {
  program.set("moved_count", moved);
  glBindTextureUnit(4, source.node.name());
  glBindTextureUnit(5, slot_of_node_.texture());
  glBindTextureUnit(6, moved_.texture());
}

void DepthWarp::warp(const WarpLayers& source, const Pose& T_world_camera, std::span<const Pose> T_world_node,
                     bool keeps) {
  const Pose T_source_target = source.T_world_camera.inverse() * T_world_camera;
  const int moved = find_moved(source, T_world_camera, T_world_node);
  spread(source, T_source_target);
  list_tiles(source, T_source_target, moved, keeps);
  auto& programs = programs_[keeps ? 1 : 0];
  const Writes what = keeps ? Writes::what_others_have_not : Writes::all;
  if (!programs) programs = Programs{warp_program(false, false, what), warp_program(true, false, what), std::nullopt};
  bind(source);
  glBindImageTexture(0, picture_.name(), 0, GL_FALSE, 0, keeps ? GL_READ_WRITE : GL_WRITE_ONLY, GL_RGBA8);
  glBindImageTexture(1, holes_.name(), 0, GL_FALSE, 0, keeps ? GL_READ_WRITE : GL_WRITE_ONLY, GL_R8);
  glBindImageTexture(2, depth_.name(), 0, GL_FALSE, 0, keeps ? GL_READ_WRITE : GL_WRITE_ONLY, GL_R32F);
  glBindTextureUnit(4, corners_.texture());
  work_off(Tiles::smooth, programs->smooth, source, T_source_target);
  work_off(Tiles::searched, programs->searched, source, T_source_target);
  if (moved > 0) {
    if (!programs->moved) programs->moved = warp_program(true, true, what);
    bind_moved(*programs->moved, source, moved);
    work_off(Tiles::moved, *programs->moved, source, T_source_target);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

void DepthWarp::list_holes(const gl::Texture& holes) {
  if (!hole_tiles_) hole_tiles_ = gl::Program::compute(gl::warp_shaders(), "hole_tiles.comp");
  const Eigen::Vector2i tiles = tiles_of(target_);
  gl::Buffer& list = lists_[static_cast<std::size_t>(Tiles::searched)].buffer();
  list.write(std::span<const GLuint>(kNoGroups));
  hole_tiles_.set("tiles", tiles);
  glBindTextureUnit(0, holes.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, list.name());
  hole_tiles_.dispatch(tiles.x(), tiles.y());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_COMMAND_BARRIER_BIT | GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
}

void DepthWarp::mend(const WarpLayers& behind, const Pose& T_world_camera, std::span<const Pose> T_world_node) {
  mend(behind, T_world_camera, T_world_node, picture_, holes_);
}

void DepthWarp::mend(const WarpLayers& behind, const Pose& T_world_camera, std::span<const Pose> T_world_node,
                     const gl::Texture& picture, const gl::Texture& holes) {
  const Pose T_source_target = behind.T_world_camera.inverse() * T_world_camera;
  const int moved = find_moved(behind, T_world_camera, T_world_node);
  spread(behind, T_source_target);
  list_holes(holes);
  gl::Program& program = mending_[moved > 0 ? 1 : 0];
  if (!program) program = warp_program(true, moved > 0, Writes::holes);
  bind(behind);
  if (moved > 0) bind_moved(program, behind, moved);
  glBindImageTexture(0, picture.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  glBindImageTexture(1, holes.name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_R8);
  glBindImageTexture(2, depth_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  mended_.start(kMendedBinding);
  work_off(Tiles::searched, program, behind, T_source_target);
  mended_.finish();
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

}  // namespace foresight
