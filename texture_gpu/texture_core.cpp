#include "texture_gpu/texture_core.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "gl/context.hpp"
#include "texture_gpu/frame_gate.hpp"

namespace foresight {
namespace {

constexpr int kExposurePages = 600;
constexpr double kGpuTimeout = 20;                          // seconds for one frame, software renderers included
constexpr std::chrono::milliseconds kDisplayTimeout{5000};  // for the display to move on to newer textures

std::vector<Lens> all_lenses(const Lens& left, const std::optional<Lens>& right) {
  return right ? std::vector{left, *right} : std::vector{left};
}

}  // namespace

TextureCore::TextureCore(std::shared_ptr<const SceneModel> scene, const std::shared_ptr<const SurfacePatches>& surface,
                         const Lens& left, const std::optional<Lens>& right, const TextureOptions& options,
                         bool software_renderer)
    : scene_(std::move(scene)),
      options_(options),
      atlas_(surface, options),
      store_(atlas_),
      exposures_(right ? 2 : 1),
      buffers_(std::make_shared<gl::SceneBuffers>(*scene_)),
      raster_(buffers_, false),
      extract_(all_lenses(left, right)),
      fill_(*surface),
      lamp_finder_(scene_),
      clock_(software_renderer),
      charts_(GL_RGBA32F, 16, "planned charts") {
  cameras_.push_back(std::make_shared<CameraInput>(left, options.margin_px));
  if (right) cameras_.push_back(std::make_shared<CameraInput>(*right, options.margin_px));
  // The first image is fused with an empty generation.
  current_ = next_generation();
  atlas_.write_table(table_);
  atlas_.write_charts(chart_rows_);
  current_->table.assign(std::span<const std::uint32_t>(table_));
  current_->charts.assign(std::span<const Eigen::Vector4f>(chart_rows_));
  current_->means.reserve(surface->charts.size() * atlas::kTexelBytes);
  current_->means.buffer().clear_to_zero();
  current_->coarse.buffer().clear_to_zero();
}

/// A stage ends. What follows may have to wait for the display.
void TextureCore::mark(const char* stage) {
  clock_.mark(stage);
  next_slice(gate_, stage);
}

ExtractionReport TextureCore::process(const PosedFrame& frame, LatestTextures& latest) {
  clock_.start();
  look(frame);
  return extract(frame, latest);
}

bool TextureCore::look(const PosedFrame& frame, LatestImage& latest) {
  clock_.start();
  choose_cameras();
  look(frame);
  if (number_ == 0) return false;
  // The pages of the image before tell the exposure as well as its own, which are not planned yet.
  estimate_exposure();
  publish(frame.left, latest);
  return true;
}

ExtractionReport TextureCore::extract(const PosedFrame& frame, LatestTextures& latest) {
  ExtractionReport report;
  clock_.resume();
  if (gate_) gate_->begin("pages");
  ChartAtlas::Allocation allocation;
  if (!allocate(allocation)) return report;
  extract_.upload_heights(atlas_, allocation.new_heights, store_);
  if (!allocation.new_heights.empty()) survey_.set_pages(records_ = atlas_.placed_records());
  mark("prepare");
  if (!exposure_known_) estimate_exposure();

  Generation next = next_generation();
  atlas_.write_table(table_);
  next->table.assign(std::span<const std::uint32_t>(table_));
  next->charts.assign(std::span<const Eigen::Vector4f>(chart_rows_));
  write_ages(frame.left.time, *next);
  next->places.clear();
  for (const AtlasChart& chart : atlas_.charts()) next->places.push_back({chart.raster.density, chart.first_page});
  extract_.relevel(allocation.relevel, next->charts, *current_, store_);
  mark("prepare");
  atlas_.write_job_geometry(allocation.jobs, views_, geometry_);
  extract_.extract({allocation.jobs, allocation.masks, geometry_}, inputs_, store_, options_.depth_tolerance,
                   options_.worse, gate_);
  mark("extract");
  fill_and_finish(allocation, *next);

  next->number = ++number_;
  next->newest_image = frame.left.time;
  next->light = light_;
  next->light_age = light_ ? static_cast<float>(to_seconds(frame.left.time - light_since_)) : -1;
  next->display_gain = static_cast<float>(std::exp(exposures_[0].log_gain()));
  atlas_.commit();
  retired_.push_back({current_, std::move(allocation.retired)});
  current_ = next;
  latest.publish(next);
  clock_.mark("publish");
  if (gate_) gate_->end();
  ++image_;

  report.published = true;
  report.newest_image = frame.left.time;
  report.published_at = std::chrono::steady_clock::now();
  report.number = number_;
  report.stages = clock_.read();
  report.log_gain = exposures_[0].log_gain();
  report.lamp = lamp_finder_.answer();
  report.pages = allocation.jobs.size();
  report.tiles = extract_.tiles();
  report.bytes_in_use = atlas_.bytes_in_use();
  report.bytes_reserved = store_.held().bytes();
  report.texels_resident = std::uint64_t{atlas_.resident_pages()} * atlas::kPage * atlas::kPage;
  report.policy = atlas_.policy();
  return report;
}

/// A published image stays as it is while it is shown: the next one goes to another place.
void TextureCore::choose_cameras() {
  const auto free = std::ranges::find_if(images_lent_, [&](const auto& image) {
    return image != newest_image_ && image->leases.load(std::memory_order_acquire) == 0;
  });
  if (free != images_lent_.end()) {
    newest_image_ = *free;
  } else {
    newest_image_ = images_lent_.emplace_back(std::make_shared<PublishedImage>());
    newest_image_->camera = std::make_shared<CameraInput>(cameras_[0]->lens(), options_.margin_px);
  }
  cameras_[0] = newest_image_->camera;
}

void TextureCore::publish(const PosedImage& image, LatestImage& latest) {
  PublishedImage& out = *newest_image_;
  out.image = {{}, image.time, image.T_world_camera, image.scene, image.margin_px};
  out.tone = {1, static_cast<float>(exposures_[0].vignetting().x()),
              static_cast<float>(exposures_[0].vignetting().y())};
  out.gain = static_cast<float>(std::exp(exposures_[0].log_gain()));
  out.light = light_;
  out.depth_tolerance = options_.depth_tolerance;
  gl::Fence::insert().wait(kGpuTimeout);
  latest.publish(newest_image_);
  clock_.mark("publish");
}

/// Image upload, depth and uncertain edges of every camera of the frame.
void TextureCore::look(const PosedFrame& frame) {
  exposure_known_ = false;
  if (gate_) gate_->begin("image");
  images_ = {&frame.left};
  if (frame.right && cameras_.size() > 1) images_.push_back(&*frame.right);
  active_.clear();
  views_.clear();
  for (std::size_t i = 0; i < images_.size(); ++i) {
    cameras_[i]->upload(images_[i]->pixels);
    active_.push_back(cameras_[i].get());
  }
  mark("upload");
  for (std::size_t i = 0; i < images_.size(); ++i)
    raster_(images_[i]->T_world_camera, images_[i]->scene, cameras_[i]->faces());
  mark("depth");
  for (std::size_t i = 0; i < images_.size(); ++i) {
    edges_(*cameras_[i], images_[i]->margin_px.value_or(options_.margin_px), options_.depth_tolerance);
    AtlasView view{&cameras_[i]->lens(), &cameras_[i]->faces().faces, {}};
    const Pose T_camera_world = images_[i]->T_world_camera.inverse();
    for (const Pose& T_world_node : images_[i]->scene.T_world_node)
      view.T_camera_node.push_back(T_camera_world * T_world_node);
    views_.push_back(std::move(view));
  }
  mark("edges");
  inputs_.update(active_, images_, std::vector<Eigen::Vector3f>(images_.size(), {1, 0, 0}));
  if (!options_.shadows) return;
  find_lamp();
  take_out_shadows();
}

/// Before its shadows are taken out of the image.
void TextureCore::find_lamp() {
  const PosedImage& image = *images_[0];
  if (!lamp_finder_.look(image.scene)) return;
  if (witnesses_ != lamp_finder_.number()) witness_pass_.set_witnesses(lamp_finder_.witnesses());
  witnesses_ = lamp_finder_.number();
  lamp_finder_.add(image.scene, image.T_world_camera.translation(),
                   witness_pass_.brightness(inputs_, image.T_world_camera, options_.depth_tolerance));
  mark("lamp");
}

void TextureCore::take_out_shadows() {
  const auto& lamp = lamp_finder_.lamp();
  if (!lamp) return light_.reset();
  if (!light_) light_since_ = images_[0]->time;
  if (!light_ || light_->lamp != *lamp || light_->moving != lamp_finder_.moving())
    light_ = std::make_shared<const SceneLight>(SceneLight{*lamp, lamp_finder_.moving()});
  if (!shadow_map_) shadow_map_ = std::make_unique<ShadowMap>(buffers_);
  bool shaded = false;
  for (std::size_t i = 0; i < images_.size(); ++i) {
    if (i == 0 || images_[i]->time != images_[0]->time) shaded = shadow_map_->update(*light_, images_[i]->scene);
    if (!shaded) continue;
    if (i >= shadows_.size()) shadows_.emplace_back(cameras_[i]->lens());
    const CameraInput& camera = *cameras_[i];
    shadows_[i]({camera.lens(), camera.block(), camera.faces(), camera.rays(), images_[i]->T_world_camera},
                *shadow_map_);
    shadows_[i].take_out_of(camera.image());
  }
  mark("shadows");
}

/// Plans resolutions, asks the GPU which pages are seen, and gives them places; again with lower
/// resolutions until they fit.
bool TextureCore::allocate(ChartAtlas::Allocation& out) {
  reclaim();
  for (;;) {
    records_ = atlas_.plan(views_, image_);
    atlas_.write_charts(chart_rows_);
    charts_.assign(std::span<const Eigen::Vector4f>(chart_rows_));
    survey_.set_pages(records_);
    const auto masks = survey_.cull(inputs_, charts_, options_.depth_tolerance);
    if (!wait_for_slots(atlas_.slots_needed(masks))) return false;
    if (!store_.hold(atlas_.reach(masks))) atlas_.limit(store_.held());
    out = atlas_.allocate(masks, image_);
    if (out.fits) break;
  }
  mark("plan");
  return true;
}

void TextureCore::estimate_exposure() {
  if (!options_.even_exposure) return;
  // Enough pages for a median; each image asks others, so that all get references.
  const int stride = std::max(1, static_cast<int>(records_.size()) / kExposurePages);
  const int first = static_cast<int>(image_ % stride);
  std::vector<AtlasPage*> pages;
  for (std::size_t i = static_cast<std::size_t>(first); i < records_.size(); i += static_cast<std::size_t>(stride))
    pages.push_back(&atlas_.page_of(records_[i]));
  std::vector<Eigen::Vector3f> tones;
  for (std::size_t i = 0; i < active_.size(); ++i) {
    exposures_[i].update(
        survey_.brightness(inputs_, charts_, store_, static_cast<int>(i), options_.depth_tolerance, first, stride),
        pages, image_);
    tones.emplace_back(std::exp(-exposures_[i].log_gain()), exposures_[i].vignetting().x(),
                       exposures_[i].vignetting().y());
  }
  inputs_.update(active_, images_, tones);
  exposure_known_ = true;
  mark("exposure");
}

void TextureCore::write_ages(RobotTime now, PublishedTextures& next) {
  constexpr std::size_t kRemembered = 4096;  // images; what was seen before them is taken as seen with the oldest
  image_times_.push_back(now);
  if (image_times_.size() > kRemembered) image_times_.pop_front();
  const std::int64_t oldest = image_ + 1 - static_cast<std::int64_t>(image_times_.size());
  ages_.clear();
  for (const AtlasChart& chart : atlas_.charts())
    for (const AtlasPage& page : chart.page)
      ages_.push_back(
          page.last_seen < 0
              ? -1.0f
              : static_cast<float>(to_seconds(
                    now - image_times_[static_cast<std::size_t>(std::max(page.last_seen - oldest, std::int64_t{0}))])));
  next.ages.assign(std::span<const float>(ages_));
}

/// Coarse colours of charts that did not change move with their place in the page table.
void TextureCore::list_fill_work(const ChartAtlas::Allocation& allocation) {
  const auto& charts = atlas_.charts();
  std::vector<bool> changed(charts.size());
  for (const PageJob& job : allocation.jobs) changed[job.chart] = true;
  dirty_.clear();
  kept_.clear();
  chart_of_page_.clear();
  first_page_before_.resize(charts.size(), 0);
  for (std::size_t i = 0; i < charts.size(); ++i) {
    const int count = charts[i].pages.prod();
    chart_of_page_.insert(chart_of_page_.end(), static_cast<std::size_t>(count), static_cast<std::uint32_t>(i));
    const int before = std::exchange(first_page_before_[i], charts[i].first_page);
    if (count == 0) continue;
    if (changed[i] || charts[i].relevelled) {
      dirty_.push_back(static_cast<std::uint32_t>(i));
    } else if (!kept_.empty() && kept_.back()[0] + kept_.back()[2] == before &&
               kept_.back()[1] + kept_.back()[2] == charts[i].first_page) {
      kept_.back()[2] += count;
    } else {
      kept_.push_back({before, charts[i].first_page, count});
    }
  }
}

void TextureCore::fill_and_finish(const ChartAtlas::Allocation& allocation, PublishedTextures& next) {
  list_fill_work(allocation);
  next.coarse.reserve(static_cast<std::size_t>(atlas_.page_count()) * atlas::kTexelBytes);
  next.means.reserve(atlas_.charts().size() * atlas::kTexelBytes);
  fill_(extract_, {allocation.jobs.size(), dirty_, chart_of_page_, kept_}, store_, *current_, next, gate_);
  // The flip must not show what the GPU has not finished.
  gl::Fence::insert().wait(kGpuTimeout);
  gl::check_errors("texture extraction");
  clock_.mark("fill");
}

/// Takes back what retired generations held, oldest first, as far as the display let go of them.
void TextureCore::reclaim() {
  while (!retired_.empty() && retired_.front().generation->leases.load(std::memory_order_acquire) == 0) {
    atlas_.give_back_colours(retired_.front().slots);
    pool_.push_back(std::move(retired_.front().generation));
    pool_.back()->colours.reset();  // an atlas that was outgrown goes with the last that shows it
    retired_.pop_front();
  }
}

bool TextureCore::wait_for_slots(std::size_t needed) {
  const auto deadline = std::chrono::steady_clock::now() + kDisplayTimeout;
  while (atlas_.free_colour_slots() < needed && !retired_.empty()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    reclaim();
  }
  return true;  // with all of them back, the atlas decides by its policy
}

TextureCore::Generation TextureCore::next_generation() {
  if (!pool_.empty()) {
    Generation reused = std::move(pool_.back());
    pool_.pop_back();
    reused->colours = store_.colours;
    return reused;
  }
  auto fresh = std::make_shared<PublishedTextures>();
  fresh->table = gl::BufferTexture(GL_R32UI, 16, "page table");
  fresh->charts = gl::BufferTexture(GL_RGBA32F, 16, "charts");
  fresh->coarse = gl::BufferTexture(atlas::kColourFormat, 16, "page means");
  fresh->means = gl::BufferTexture(atlas::kColourFormat, 16, "chart means");
  fresh->ages = gl::BufferTexture(GL_R32F, 16, "page ages");
  fresh->colours = store_.colours;
  return fresh;
}

}  // namespace foresight
