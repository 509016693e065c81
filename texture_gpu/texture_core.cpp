#include "texture_gpu/texture_core.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "gl/context.hpp"
#include "texture_gpu/frame_gate.hpp"

namespace foresight {
namespace {

// Enough for a median of an image; of an average over ten images half as many.
constexpr std::size_t kComparedPages = 600, kPagesPerAligned = 2;
constexpr int kMostAccumulated = 320 * 240;  // px of an image, by a software renderer
// Images within which a page that stays in view is written anyway; the same after the lamp became known or was lost.
constexpr std::uint64_t kImagesToRefresh = 32, kImagesToRelight = 8;
constexpr std::uint64_t kShareOfImages = 4;          // images that are kept get so much less memory than textures
constexpr std::uint64_t kRehearsedWithoutLight = 3;  // images
constexpr double kGpuTimeout = 20;                   // seconds for one frame, software renderers included

std::vector<Lens> all_lenses(const Lens& left, const std::optional<Lens>& right) {
  return right ? std::vector{left, *right} : std::vector{left};
}

}  // namespace

TextureCore::TextureCore(const std::shared_ptr<const SceneModel>& scene,
                         const std::shared_ptr<const SurfacePatches>& surface, const Lens& left,
                         const std::optional<Lens>& right, const TextureOptions& options, bool software_renderer)
    : surface_(surface),
      options_(options),
      atlas_(surface, options),
      store_(atlas_),
      places_(left, right, options.margin_px),
      kept_images_(options.images, options.memory_bytes / kShareOfImages),
      exposures_(right ? 2 : 1),
      buffers_(std::make_shared<gl::SceneBuffers>(*scene)),
      raster_(buffers_, false),
      survey_(all_lenses(left, right)),
      extract_(all_lenses(left, right)),
      fill_(*surface),
      light_(scene, buffers_, options.awaits_lamp),
      old_shadows_(buffers_),
      clock_(software_renderer),
      charts_(GL_RGBA32F, 16, "planned charts") {
  if (options.images > 1) still_pass_ = std::make_unique<StillPass>(left);
  if (options.accumulate.value_or(!software_renderer || left.width() * left.height() <= kMostAccumulated))
    accumulation_pass_ = std::make_unique<AccumulationPass>(left, buffers_);
  // The first image is fused with an empty generation.
  current_ = generations_.take(store_);
  atlas_.write_table(table_);
  atlas_.write_charts(chart_rows_);
  current_->table.assign(std::span<const std::uint32_t>(table_));
  current_->charts.assign(std::span<const Eigen::Vector4f>(chart_rows_));
  current_->means.reserve(surface->charts.size() * atlas::kMeanBytes);
  current_->means.buffer().clear_to_zero();
  current_->coarse.buffer().clear_to_zero();
}

/// A stage ends. The next one finds samplers as always, and may have to wait for the display.
void TextureCore::mark(const char* stage) {
  reset_samplers_();
  clock_.mark(stage);
  next_slice(gate_, stage);
}

ExtractionReport TextureCore::process(const PosedFrame& frame, LatestTextures& latest) {
  clock_.start();
  {
    const SlicedWork slices(gate_, "image");
    look(frame);
  }
  looked_up_ = false;
  return extract(latest);
}

bool TextureCore::look(const PosedFrame& frame, LatestImages& latest) {
  clock_.start();
  const SlicedWork slices(gate_, "image");
  look(frame);
  looked_up_ = number_ > 0;
  if (!looked_up_) return false;
  // The pages of the image before tell as much as its own, which are not planned yet.
  compare_with_textures();
  publish(latest);
  return true;
}

ExtractionReport TextureCore::extract(LatestTextures& latest, LatestImages* images) {
  clock_.resume();
  const SlicedWork slices(gate_, "textures");
  if (owed_ && save_what_leaves(latest) && looked_up_ && images) images->publish(lend(false));
  note_light();
  if (newest_.light && !old_shadows_.empty()) take_out_old_shadows(latest);
  ChartAtlas::Allocation allocation;
  if (!allocate(allocation)) return {};
  ages_.update(atlas_.charts(), image_, newest_.time(), light_changed_);
  write(newest_, std::move(allocation), latest);
  atlas_.commit();
  ++image_;
  return report();
}

void TextureCore::note_light() {
  const bool lit = newest_.light != nullptr;
  if (!lit && options_.shadows)
    old_shadows_.note(
        {image_, newest_.time(), newest_.images[0].scene, newest_.images[0].T_world_camera.translation()});
  if (lit == lit_) return;
  lit_ = lit;
  light_changed_ = image_;
  in_light_since_ = newest_.time();
}

/// The lamp has become known: what textures hold of images before is as if it had been.
void TextureCore::take_out_old_shadows(LatestTextures& latest) {
  const OldShadows::Pages pages = old_shadows_.in_shadow(atlas_, *newest_.light);
  if (!pages.list.empty()) {
    const bool is_room = generations_.wait_for_slots(atlas_, pages.list.size()) &&
                         atlas_.free_colour_slots() >= pages.list.size() &&
                         store_.hold(atlas_.reach(pages.list.size()));
    if (!is_room) return;
    write(newest_, atlas_.renew(pages.list), latest, &pages);
  }
  light_changed_ = old_shadows_.oldest().number;
  in_light_since_ = old_shadows_.oldest().time;
  old_shadows_.clear();
}

/// From the image's pages to a published generation.
void TextureCore::write(const FrameOnGpu& frame, ChartAtlas::Allocation allocation, LatestTextures& latest,
                        const OldShadows::Pages* in_old_shadows) {
  extract_.upload_heights(atlas_, allocation.new_heights, store_);
  if (!allocation.new_heights.empty()) survey_.set_pages(records_ = atlas_.placed_records());
  mark("prepare");
  if (!frame.compared) compare_with_textures();

  GenerationPool::Generation next = generations_.take(store_);
  atlas_.write_table(table_);
  next->table.assign(std::span<const std::uint32_t>(table_));
  next->charts.assign(std::span<const Eigen::Vector4f>(chart_rows_));
  next->ages.assign(ages_.seconds());
  next->places.clear();
  for (const AtlasChart& chart : atlas_.charts()) next->places.push_back({chart.raster.density, chart.first_page});
  extract_.relevel(allocation.relevel, next->charts, *current_, store_);
  mark("prepare");
  atlas_.write_job_geometry(allocation.jobs, frame.views, geometry_);
  extract_.extract({.jobs = allocation.jobs, .masks = allocation.masks, .geometry = geometry_, .image = image_},
                   frame.inputs, store_, options_.depth_tolerance, gate_);
  mark("extract");
  if (in_old_shadows) {
    old_shadows_.take_out(*in_old_shadows, allocation.jobs, atlas_, store_, *frame.light, reset_samplers_);
    mark("old shadows");
  }
  fill_and_finish(allocation, *next);
  atlas_.note_holes(allocation, extract_.read_holes(allocation.jobs.size()));
  count(allocation);

  next->number = ++number_;
  next->newest_image = frame.time();
  next->sharp = static_cast<float>(std::min(sharpness_.cubic_share(), SharpnessEstimator::kMostOfTextures));
  next->light = frame.light;
  next->light_age = frame.light ? static_cast<float>(to_seconds(frame.time() - in_light_since_)) : -1;
  next->display_gain = static_cast<float>(std::exp(frame.log_gain));
  next->vignetting = frame.vignetting.cast<float>();
  next->white_balance = frame.white_balance;
  generations_.retire(current_, std::move(allocation.retired));
  current_ = next;
  latest.publish(next);
  clock_.mark("publish");
}

void TextureCore::count(const ChartAtlas::Allocation& allocation) {
  done_.pages += allocation.jobs.size();
  done_.tiles += extract_.tiles();
  done_.texels_written += (extract_.tiles() + extract_.copied()) * atlas::kTile * atlas::kTile +
                          allocation.relevel.size() * atlas::kPage * atlas::kPage;
}

ExtractionReport TextureCore::report() {
  ExtractionReport out = std::exchange(done_, {});
  out.published = true;
  out.newest_image = newest_.time();
  out.published_at = std::chrono::steady_clock::now();
  out.number = number_;
  out.stages = clock_.read();
  out.log_gain = exposures_[0].log_gain();
  if (const auto square = sharpness_.misplacement2()) out.misplacement_px = std::sqrt(*square);
  out.lamp = light_.answer();
  out.right_factors = balance_.factors();
  out.images_kept = kept_images_.images().size();
  out.bytes_in_use = atlas_.bytes_in_use();
  out.bytes_reserved = store_.held().bytes();
  out.texels_resident = std::uint64_t{atlas_.resident_pages()} * atlas::kPage * atlas::kPage;
  out.policy = atlas_.policy();
  return out;
}

void TextureCore::publish(LatestImages& latest) {
  for (std::size_t i = 0; i < newest_.images.size(); ++i) {
    PublishedImage& out = *newest_.published[i];
    const ExposureEstimator& exposure = exposures_[i];
    out.image = newest_.images[i];
    if (!out.image.margin_px) out.image.margin_px = options_.margin_px;
    out.tone = {1, static_cast<float>(exposure.vignetting().x()), static_cast<float>(exposure.vignetting().y())};
    out.gain = static_cast<float>(std::exp(exposure.log_gain()));
    out.white_balance = white_balance_.factors_on_image();
    out.white_balance_of_textures = white_balance_.factors();
    out.sharp = static_cast<float>(sharpness_.cubic_share());
    out.light = newest_.light;
    out.depth_tolerance = options_.depth_tolerance;
  }
  newest_.lent = true;
  if (accumulation_pass_) accumulate();
  if (still_pass_) keep_newest();
  gl::Fence::insert().wait(kGpuTimeout);
  const bool same_light = (newest_.light == nullptr) == (before_.light == nullptr);
  latest.publish(lend(owed_ && same_light));
  clock_.mark("publish");
}

std::shared_ptr<const NewestImages> TextureCore::lend(bool with_before) const {
  const std::shared_ptr<PublishedImage>& newest = newest_.published[0];
  auto images = std::make_shared<NewestImages>();
  images->newest = Lease<PublishedImage>(newest);
  if (with_before) images->before = Lease<PublishedImage>(before_.published[0]);
  if (!still_pass_) return images;
  if (right_is_alike_ && is_exposure_known(1)) images->others.emplace_back(newest_.published[1]);
  for (const auto& image : kept_images_.images())
    if (image != newest) images->others.emplace_back(image);
  return images;
}

void TextureCore::accumulate() {
  if (before_.lent) (*accumulation_pass_)(*newest_.published[0], *before_.published[0]);
  mark("accumulation");
}

void TextureCore::keep_newest() {
  const std::shared_ptr<PublishedImage>& newest = newest_.published[0];
  newest->range = typical_range(*surface_, newest->camera->lens(), newest->image);
  (*still_pass_)(*newest, before_.published.empty() ? nullptr : before_.published[0].get());
  if (is_exposure_known(0)) kept_images_.keep(newest);  // later ones are shown as bright as these were
  mark("kept images");
}

bool TextureCore::is_exposure_known(std::size_t camera) const {
  return !options_.even_exposure || exposures_[camera].is_measured();
}

/// Image upload, depth and uncertain edges of every camera of the frame.
void TextureCore::look(const PosedFrame& frame) {
  std::swap(newest_, before_);
  places_.place(frame, before_, newest_);
  const std::size_t count = newest_.images.size();
  left_ = frame.left.pixels;
  const cv::Mat left = options_.even_exposure ? white_balance_.apply(left_) : left_;
  newest_.cameras[0]->upload(left);
  cv::Mat right;
  if (count > 1) {
    right_ = frame.right->pixels;
    right = options_.even_exposure ? balance_.apply(right_) : right_;
    newest_.cameras[1]->upload(right);
  }
  mark("upload");
  for (std::size_t i = 0; i < count; ++i)
    raster_(newest_.images[i].T_world_camera, newest_.images[i].scene, newest_.cameras[i]->faces(),
            &newest_.cameras[i]->marked_depth());
  mark("depth");
  for (std::size_t i = 0; i < count; ++i)
    edges_(*newest_.cameras[i], newest_.images[i].margin_px.value_or(options_.margin_px), options_.depth_tolerance,
           gate_);
  mark("edges");
  newest_.update_inputs(std::vector<Eigen::Vector3f>(count, {1, 0, 0}));
  newest_.log_gain = exposures_[0].log_gain();
  newest_.vignetting = exposures_[0].vignetting();
  newest_.white_balance = white_balance_.factors();
  if (options_.shadows) {
    if (light_.find_lamp(newest_, options_.depth_tolerance)) mark("lamp");
    const bool rehearses_light = rehearses_ && number_ >= kRehearsedWithoutLight;
    if (light_.take_out_shadows(newest_, rehearses_light, reset_samplers_)) mark("shadows");
  }
  newest_.light = light_.known();
  right_is_alike_ = still_pass_ && count > 1 && are_alike_in_hue(left, right);
}

/// Of the image before, what the newest one shows no more, or less well: views are going to look for it in the
/// textures. False: there was no room for all of it.
bool TextureCore::save_what_leaves(LatestTextures& latest) {
  const std::array<const CameraInput*, 2> cameras{newest_.cameras[0].get(), before_.cameras[0].get()};
  const std::array<const PosedImage*, 2> images{newest_.images.data(), before_.images.data()};
  both_.update(cameras, images, std::array<Eigen::Vector3f, 2>{{{1, 0, 0}, {1, 0, 0}}});
  const Masks shown = atlas_.not_hidden(seen_, image_ - 1);
  const SurveyPass::Missed missed =
      not_shown(both_, {newest_.views[0], before_.views[0]}, atlas_.stale(shown, image_ - 1, light_changed_));
  for (std::size_t page : missed.coarser) atlas_.note_coarser(page, image_);
  atlas_.note_hidden(missed.hidden, image_);
  mark("leaving");
  ChartAtlas::Allocation allocation;
  if (std::ranges::all_of(missed.masks, [](std::uint32_t mask) { return mask == 0; })) return true;
  if (!place(missed.masks, image_ - 1, allocation) || !allocation.fits) return false;
  write(before_, std::move(allocation), latest);
  return true;
}

/// What camera 1 of `inputs` saw of these tiles, and camera 0 does not show as well.
SurveyPass::Missed TextureCore::not_shown(const SeenInputs& inputs, const std::vector<AtlasView>& views,
                                          const Masks& tiles) {
  atlas_.write_page_geometry(tiles, views, geometry_);
  return survey_.missed(inputs, geometry_, store_, tiles, options_.depth_tolerance, options_.worse, gate_);
}

/// Plans resolutions, asks the GPU which pages are seen, and gives places to those that are to be written; again with
/// lower resolutions until they fit.
bool TextureCore::allocate(ChartAtlas::Allocation& out) {
  generations_.reclaim(atlas_);
  for (;;) {
    next_slice(gate_, "pages");
    records_ = atlas_.plan(newest_.views);
    atlas_.write_charts(chart_rows_);
    charts_.assign(std::span<const Eigen::Vector4f>(chart_rows_));
    survey_.set_pages(records_);
    seen_ = survey_.cull(newest_.inputs, charts_, options_.depth_tolerance, gate_);
    next_slice(gate_, "places");
    if (!place(needed(), image_, out)) return false;
    if (out.fits) break;
  }
  mark("plan");
  return true;
}

/// Of what the newest image shows, what the textures have to have at once.
TextureCore::Masks TextureCore::needed() {
  owed_ = options_.only_what_is_needed && looked_up_;
  if (!owed_) return seen_;
  atlas_.note_seen(seen_, image_);
  Masks out = atlas_.not_held(seen_, image_);
  for (std::size_t i = 0; i < out.size(); ++i) {
    // A part of them with each image: all at once would take twice the room.
    const bool in_old_light = atlas_.page_of(records_[i]).written < light_changed_;
    if (records_[i].has_turn(image_, in_old_light ? kImagesToRelight : kImagesToRefresh)) out[i] = seen_[i];
  }
  if (newest_.images.size() < 2) return out;
  // Views look the left image up only.
  const Masks missed = not_shown(newest_.inputs, newest_.views, atlas_.stale(seen_, image_, light_changed_)).masks;
  for (std::size_t i = 0; i < out.size(); ++i) out[i] |= missed[i];
  return out;
}

bool TextureCore::place(const Masks& wanted, std::int64_t image, ChartAtlas::Allocation& out) {
  if (!generations_.wait_for_slots(atlas_, atlas_.slots_needed(wanted))) return false;
  if (!store_.hold(atlas_.reach(wanted))) atlas_.limit(store_.held());
  out = atlas_.allocate(wanted, image);
  return true;
}

/// How bright the new image is beside those before, and how well it lies on them.
void TextureCore::compare_with_textures() {
  if (options_.even_exposure) estimate_exposure();
  // Each image others.
  const std::size_t turns = kPagesPerAligned * std::max<std::size_t>(1, records_.size() / kComparedPages);
  std::vector<PageRecord> pages;
  for (std::size_t i = static_cast<std::size_t>(image_) % turns; i < records_.size(); i += turns)
    pages.push_back(records_[i]);
  sharpness_.update(survey_.agreement(newest_.inputs, charts_, store_, pages, *current_, options_.depth_tolerance));
  newest_.compared = true;
  mark("exposure");
}

/// Of those that have a place. Each image asks others, so that all get references, and half of those that the image
/// before asked, whose references are there.
std::vector<PageRecord> TextureCore::pages_of_exposure() const {
  std::vector<PageRecord> placed, out;
  std::ranges::copy_if(records_, std::back_inserter(placed),
                       [](const PageRecord& page) { return page.height_slot != atlas::kNoSlot; });
  const std::size_t turns = std::max<std::size_t>(1, 2 * placed.size() / kComparedPages);
  const std::size_t now = static_cast<std::size_t>(image_) % turns, next = (now + 1) % turns;
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (i % turns == now || i % turns == next) out.push_back(placed[i]);
  return out;
}

void TextureCore::estimate_exposure() {
  const std::vector<PageRecord> records = pages_of_exposure();
  std::vector<AtlasPage*> pages;
  for (const PageRecord& record : records) pages.push_back(&atlas_.page_of(record));
  std::vector<Eigen::Vector3f> tones;
  for (std::size_t i = 0; i < newest_.images.size(); ++i) {
    const auto samples =
        survey_.brightness(newest_.inputs, charts_, store_, records, static_cast<int>(i), options_.depth_tolerance);
    // Of an image that shadows were taken out of, either correction waits for the next.
    if (i == 0 && white_balance_.learn(samples, pages) && !newest_.light)
      newest_.cameras[0]->upload(white_balance_.apply(left_));
    exposures_[i].update(samples, pages, image_);
    if (i == 1 && balance_.learn(samples, pages) && !newest_.light) newest_.cameras[1]->upload(balance_.apply(right_));
    tones.emplace_back(std::exp(-exposures_[i].log_gain()), exposures_[i].vignetting().x(),
                       exposures_[i].vignetting().y());
  }
  newest_.update_inputs(tones);
  newest_.log_gain = exposures_[0].log_gain();
  newest_.vignetting = exposures_[0].vignetting();
  newest_.white_balance = white_balance_.factors();
}

void TextureCore::fill_and_finish(const ChartAtlas::Allocation& allocation, PublishedTextures& next) {
  next.coarse.reserve(static_cast<std::size_t>(atlas_.page_count()) * atlas::kMeanBytes);
  next.means.reserve(atlas_.charts().size() * atlas::kMeanBytes);
  fill_(extract_, fill_list_.list(atlas_.charts(), allocation.jobs), store_, *current_, next, gate_);
  // The flip must not show what the GPU has not finished.
  gl::Fence::insert().wait(kGpuTimeout);
  gl::check_errors("texture extraction");
  clock_.mark("fill");
}

}  // namespace foresight
