// Looks on at a view and measures it: against the camera's own image of each shown instant.
#pragma once

#include "apps/replay_report/instants.hpp"
#include "apps/replay_report/replay_report.hpp"
#include "apps/view_outputs.hpp"
#include "display/view_loop.hpp"
#include "texture_gpu/lamp/lamp_words.hpp"

namespace foresight {

/// What is known of a session before its first image, as a report begins: all but the run's name and options of its
/// own.
RunRecord describe(const ViewSession& session, const ViewSetup& setup);
/// The textures' options, as all reports have them.
void add_texture_options(RunRecord& record, const TextureOptions& textures);

/// Reads every view back and compares; writes the pictures and keeps those of a few instants.
class ViewMeasures final : public ViewObserver {
 public:
  /// `record`: described; its options are complete. Makes the folder for pictures. Throws RuntimeFailure.
  ViewMeasures(RunRecord record, ViewOutputs outputs, const TextureOptions& textures);

  void arrived(const PosedFrame& frame) override;
  void stepped(const ViewStep& step, FrameSource& source, ViewSession& session) override;

  /// For what only the command knows, such as notes.
  RunRecord& record() { return record_; }
  const RunRecord& record() const { return record_; }

  /// Counts the images that were lost on the way, says what the memory policy did, and writes all reports; `title` is
  /// the contact sheet's. Throws RuntimeFailure.
  void finish(const FrameSource& source, const ViewSession& session, const std::string& title);

 private:
  FrameRecord new_record(const ShownInstant& instant) const;
  void take(const ExtractionReport& report, FrameRecord& record);
  void measure(FrameRecord& record, double draw_cpu_ms, FrameSource& source, ViewSession& session);
  void note_policy();

  RunRecord record_;
  ViewOutputs outputs_;
  TextureOptions textures_;
  InstantKeeper keeper_{4};
  cv::Mat delayed_;
  RobotTime delayed_time_;
  std::uint64_t bytes_used_ = 0;
  double gain_ = 1;
  std::optional<double> misplacement_px_;
  ChartAtlas::Policy policy_;
  LampHistory lamp_;
  std::optional<Eigen::Vector2d> right_factors_;  // ExtractionReport::right_factors
};

/// What was measured, in a few lines on stdout.
void print_summary(const RunRecord& record);

}  // namespace foresight
