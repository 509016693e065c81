// What ChartAtlas writes for the GPU.
#include "texture_gpu/chart_atlas.hpp"

namespace foresight {

void ChartAtlas::append_geometry(const PageJob& job, std::span<const AtlasView> views,
                                 std::vector<Eigen::Vector4f>& out) const {
  const auto slot = [](std::uint32_t s) { return s == atlas::kNoSlot ? -1.0 : static_cast<double>(s); };
  const ChartRaster& r = charts_[job.chart].raster;
  const Patch& patch = surface_->patches[static_cast<std::size_t>(surface_->charts[job.chart].patch)];
  const Eigen::Vector2d uv =
      r.uv0 + atlas::kPage * Eigen::Vector2d(job.xy & 0xffff, job.xy >> 16).cwiseQuotient(r.density);
  const Eigen::Vector3d corner = patch.origin + uv.x() * patch.eu + uv.y() * patch.ev + r.height0 * patch.n;
  for (const AtlasView& view : views) {
    const Pose& T = view.T_camera_node[static_cast<std::size_t>(patch.node)];
    const auto row = [&](const Eigen::Vector3d& v, double w) {
      out.push_back(Eigen::Vector4d(v.x(), v.y(), v.z(), w).cast<float>());
    };
    row(T * corner, slot(job.height_slot));
    row(T.linear() * patch.eu / r.density.x(), slot(job.old_slot));
    row(T.linear() * patch.ev / r.density.y(), slot(job.new_slot));
    row(T.linear() * patch.n * r.height_step, job.worse);
  }
}

void ChartAtlas::write_job_geometry(std::span<const PageJob> jobs, std::span<const AtlasView> views,
                                    std::vector<Eigen::Vector4f>& out) const {
  out.clear();
  out.reserve(4 * jobs.size() * views.size());
  for (const PageJob& job : jobs) append_geometry(job, views, out);
}

void ChartAtlas::write_page_geometry(std::span<const std::uint32_t> masks, std::span<const AtlasView> views,
                                     std::vector<Eigen::Vector4f>& out) const {
  out.clear();
  for (std::size_t i = 0; i < records_.size(); ++i) {
    const PageRecord& r = records_[i];
    const AtlasPage& page = page_of(r);
    if (masks[i]) append_geometry({r.chart, r.xy, page.colour, page.colour, page.height, 0, page.covered}, views, out);
  }
}

void ChartAtlas::write_table(std::vector<std::uint32_t>& out) const {
  out.clear();
  out.reserve(static_cast<std::size_t>(page_count_));
  for (const AtlasChart& chart : charts_)
    for (const AtlasPage& page : chart.page) out.push_back(page.colour);
}

void ChartAtlas::write_charts(std::vector<Eigen::Vector4f>& out) const {
  out.clear();
  out.reserve(5 * charts_.size());
  const auto pack4 = [&](const Eigen::Vector3d& v, double w) {
    out.push_back(Eigen::Vector4d(v.x(), v.y(), v.z(), w).cast<float>());
  };
  for (std::size_t i = 0; i < charts_.size(); ++i) {
    const AtlasChart& chart = charts_[i];
    const Patch& patch = surface_->patches[static_cast<std::size_t>(surface_->charts[i].patch)];
    const ChartRaster& r = chart.raster;
    const Eigen::Vector2d pitch = r.density.x() > 0 ? r.density.cwiseInverse().eval() : Eigen::Vector2d::Zero();
    pack4(patch.origin + r.uv0.x() * patch.eu + r.uv0.y() * patch.ev + r.height0 * patch.n, chart.pages.x());
    pack4(patch.eu * pitch.x(), r.density.x());
    pack4(patch.ev * pitch.y(), chart.first_page);
    pack4(patch.n * r.height_step, patch.node);
    pack4({r.uv0.x(), r.uv0.y(), static_cast<double>(chart.pages.y())}, r.density.y());
  }
}

}  // namespace foresight
