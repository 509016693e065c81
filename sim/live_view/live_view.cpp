#include "sim/live_view/live_view.hpp"

#include <cstring>
#include <stdexcept>

#include "sim/lamp.hpp"
#include "sim/texture.hpp"

namespace foresight::gl {
const ShaderSources& live_view_shaders();
}  // namespace foresight::gl

namespace foresight::sim {
namespace {

constexpr int kBorder = 3;          // px: the spread's
constexpr double kTimeout = 10;     // seconds
constexpr float kReadShare = 0.2f;  // as in sim/sensor.cpp

Eigen::Vector4f vec4(const Eigen::Vector3f& v, float w = 0) {
  return {v.x(), v.y(), v.z(), w};
}

// Variances of reading and of shot noise per light, for Sensor::noise; see sim/sensor.cpp.
Eigen::Vector2f noise_of(const Sensor& sensor) {
  const float mid = linear_from_srgb(128 / 255.0f);
  const float slope = (srgb_from_linear(mid * 1.001f) - srgb_from_linear(mid)) / (mid * 0.001f);
  const float sigma = static_cast<float>(sensor.noise) / 255 / slope;
  return {kReadShare * sigma * sigma, (1 - kReadShare) * sigma * sigma / mid};
}

gl::Handle<gl::delete_texture> create_samples(GLenum format, const gl::Faces& faces, const char* label) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &name);
  glTextureStorage2DMultisample(name, LiveView::kSamples, format, faces.width, faces.height, GL_TRUE);
  glObjectLabel(GL_TEXTURE, name, -1, label);
  return gl::Handle<gl::delete_texture>(name);
}

}  // namespace

LiveView::LiveView(std::shared_ptr<const LabBuffers> lab, const Lens& lens, const Sensor& sensor)
    : lab_(std::move(lab)),
      lens_(lens),
      sensor_(sensor),
      faces_(gl::faces_for(lens, kBorder)),
      array_(lab_->create_vertex_array()),
      nothing_(gl::create_vertex_array("no vertices")),
      matt_(gl::Program::graphics(gl::live_view_shaders(), "live.vert", "live.frag")),
      glossy_(gl::Program::graphics(gl::live_view_shaders(), "live.vert", "live.frag", {"GLOSS 1"})),
      resolve_(gl::Program::graphics(gl::live_view_shaders(), "whole.vert", "resolve.frag",
                                     {"SAMPLES " + std::to_string(kSamples)})),
      sensor_program_(
          gl::Program::graphics(gl::live_view_shaders(), "whole.vert", "sensor.frag",
                                sensor.noise > 0 ? std::vector<std::string>{"NOISE 1"} : std::vector<std::string>{})),
      samples_(create_samples(GL_RGBA8, faces_, "live face, in samples")),
      depth_(create_samples(GL_DEPTH_COMPONENT32F, faces_, "live depth")),
      colour_(GL_RGBA8, faces_.width, faces_.height, faces_.count, 1, "live faces"),
      places_(GL_RGBA32F, lens.width(), lens.height(), 0, 1, "lens places"),
      yuyv_(GL_RGBA8, lens.width() / 2, lens.height(), 0, 1, "live image"),
      face_target_(gl::create_framebuffer("live face, in samples")),
      colour_target_(gl::create_framebuffer("live face")),
      sensor_target_(gl::create_framebuffer("live sensor")) {
  if (lens.width() % 2) throw std::invalid_argument("a YUYV image needs an even width");
  if (!lab_->prints().empty()) prints_.emplace();
  for (GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(colour_.name(), filter, GL_LINEAR);
  glNamedFramebufferTexture(face_target_.name(), GL_COLOR_ATTACHMENT0, samples_.name(), 0);
  glNamedFramebufferTexture(face_target_.name(), GL_DEPTH_ATTACHMENT, depth_.name(), 0);
  glNamedFramebufferTexture(sensor_target_.name(), GL_COLOR_ATTACHMENT0, yuyv_.name(), 0);
  set_places();
  const GLsizeiptr bytes = GLsizeiptr{2} * lens.width() * lens.height();
  constexpr GLbitfield kMap = GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  for (Slot& slot : slots_) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    slot.buffer = gl::Handle<gl::delete_buffer>(name);
    glNamedBufferStorage(name, bytes, nullptr, kMap | GL_CLIENT_STORAGE_BIT);
    slot.bytes = static_cast<const std::uint8_t*>(glMapNamedBufferRange(name, 0, bytes, kMap));
  }
}

// The lens is applied here, exactly and once: where on which face each pixel looks.
void LiveView::set_places() {
  std::vector<Eigen::Vector4f> row(static_cast<std::size_t>(lens_.width()));
  for (int v = 0; v < lens_.height(); ++v) {
    for (int u = 0; u < lens_.width(); ++u) {
      Eigen::Vector4f& place = row[static_cast<std::size_t>(u)];
      place = {0, 0, -1, 0};
      const auto ray = lens_.unproject({u, v});
      if (!ray) continue;
      for (int i = 0; i < faces_.count; ++i) {
        const Eigen::Vector3d d = gl::Faces::rotation(i) * *ray;
        if (d.z() <= 0 || (faces_.count > 1 && d.z() < d.head<2>().cwiseAbs().maxCoeff() - 1e-9)) continue;
        place = Eigen::Vector4d((faces_.fx * d.x() / d.z() + faces_.cx + 0.5) / faces_.width,
                                (faces_.fy * d.y() / d.z() + faces_.cy + 0.5) / faces_.height, i,
                                sensor_.falloff(u, v, {lens_.width(), lens_.height()}))
                    .cast<float>();
        break;
      }
    }
    glTextureSubImage2D(places_.name(), 0, 0, v, lens_.width(), 1, GL_RGBA, GL_FLOAT, row.data());
  }
}

void LiveView::draw_parts(const gl::Program& program, bool glossy, const Pose& T_face_world,
                          const LabState& T_world_part) const {
  int part = -1;
  for (const LabBuffers::Draw& draw : lab_->draws()) {
    const LabBuffers::Picture& picture = lab_->picture(draw.material);
    if ((picture.gloss > 0) != glossy) continue;
    if (draw.part != part) {
      part = draw.part;
      const Pose& T_world_node = T_world_part[static_cast<std::size_t>(part)];
      program.set("T_face_node", (T_face_world * T_world_node).matrix().cast<float>().eval());
      if (glossy) program.set("T_world_node", T_world_node.matrix().cast<float>().eval());
    }
    if (glossy) program.set("eye", vec4(T_face_world.inverse().translation().cast<float>(), picture.gloss));
    program.set("uv_scale", picture.per_metre);
    glBindTextureUnit(0, picture.texture.name());
    glDrawArrays(GL_TRIANGLES, draw.first, draw.count);
  }
}

void LiveView::draw_face(const Pose& T_face_world, const LabState& T_world_part,
                         std::span<const Pose> T_world_print) const {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_GREATER);
  glEnable(GL_CULL_FACE);
  glFrontFace(GL_CW);  // rows grow downwards: what is counter-clockwise to the eye is clockwise here
  fences_();
  glBindFramebuffer(GL_FRAMEBUFFER, face_target_.name());
  const float nothing[4] = {};
  glClearNamedFramebufferfv(face_target_.name(), GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(face_target_.name(), GL_DEPTH, 0, nothing);
  glBindTextureUnit(1, lab_->light());
  glBindVertexArray(array_.name());
  for (const bool glossy : {false, true}) {
    const gl::Program& program = glossy ? glossy_ : matt_;
    program.use();
    program.set("face", Eigen::Vector4d(faces_.fx, faces_.fy, faces_.cx, faces_.cy).cast<float>().eval());
    program.set("face_size", Eigen::Vector2i(faces_.width, faces_.height).cast<float>().eval());
    if (glossy) {
      program.set("lamp_centre", vec4(lamp::centre(), lamp::size()));
      program.set("lamp_normal", vec4(lamp::axes().normal));
      program.set("lamp_right", vec4(lamp::axes().right));
      program.set("lamp_up", vec4(lamp::axes().up));
    }
    draw_parts(program, glossy, T_face_world, T_world_part);
  }
  glBindVertexArray(nothing_.name());
  if (prints_) (*prints_)(faces_, T_face_world, lab_->prints(), T_world_print);
  glDisable(GL_CULL_FACE);
  glFrontFace(GL_CCW);
  glDisable(GL_DEPTH_TEST);
}

void LiveView::draw_faces(const Pose& T_world_camera, const LabState& T_world_part,
                          std::span<const Pose> T_world_print) const {
  glViewport(0, 0, faces_.width, faces_.height);
  for (int i = 0; i < faces_.count; ++i) {
    Pose T_face_camera = Pose::Identity();
    T_face_camera.linear() = gl::Faces::rotation(i);
    draw_face(T_face_camera * T_world_camera.inverse(), T_world_part, T_world_print);
    glNamedFramebufferTextureLayer(colour_target_.name(), GL_COLOR_ATTACHMENT0, colour_.name(), 0, i);
    fences_();
    glBindFramebuffer(GL_FRAMEBUFFER, colour_target_.name());
    resolve_.use();
    glBindTextureUnit(0, samples_.name());
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }
}

bool LiveView::draw(const Pose& T_world_camera, const LabState& T_world_part, double gain, std::uint64_t number,
                    std::span<const Pose> T_world_print) {
  if (waiting_.size() == kImages) return false;
  draw_faces(T_world_camera, T_world_part, T_world_print);
  sensor_program_.use();
  sensor_program_.set(
      "texel", Eigen::Vector2f(1.0f / static_cast<float>(faces_.width), 1.0f / static_cast<float>(faces_.height)));
  // With what looking up between texels spreads on average (variance 1 / 6), this is a blur of 0.6 px.
  sensor_program_.set("spread", 0.45f);
  sensor_program_.set("gain", static_cast<float>(gain));
  sensor_program_.set("noise", noise_of(sensor_));
  sensor_program_.set("number", static_cast<unsigned>(number * 0x9e3779b9u + sensor_.seed));
  glBindTextureUnit(0, colour_.name());
  glBindTextureUnit(1, places_.name());
  glBindVertexArray(nothing_.name());
  fences_();
  glBindFramebuffer(GL_FRAMEBUFFER, sensor_target_.name());
  glViewport(0, 0, yuyv_.width(), yuyv_.height());
  glDrawArrays(GL_TRIANGLES, 0, 3);
  Slot& slot = slots_[next_];
  glBindBuffer(GL_PIXEL_PACK_BUFFER, slot.buffer.name());
  glReadPixels(0, 0, yuyv_.width(), yuyv_.height(), GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glBindVertexArray(0);
  slot.done = gl::Fence::insert();
  waiting_.push_back(next_);
  next_ = (next_ + 1) % kImages;
  return true;
}

bool LiveView::take(std::span<std::uint8_t> out, bool wait) {
  if (waiting_.empty()) return false;
  const Slot& slot = slots_[waiting_.front()];
  if (wait)
    slot.done.wait(kTimeout);
  else if (!slot.done.signalled())
    return false;
  waiting_.pop_front();
  std::memcpy(out.data(), slot.bytes, std::min(out.size(), std::size_t{2} * lens_.width() * lens_.height()));
  return true;
}

}  // namespace foresight::sim
