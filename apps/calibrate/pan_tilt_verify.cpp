#include "apps/calibrate/pan_tilt_verify.hpp"

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "apps/calibrate/outputs.hpp"
#include "calibration/camera/camera_model.hpp"
#include "calibration/registration/calibrated_head.hpp"
#include "calibration/result/result_file.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct Sum {
  double squares = 0;
  int points = 0;
  void add(double error) { squares += error * error, ++points; }
  double px() const { return std::sqrt(squares / std::max(1, points)); }
};

struct Score : Sum {
  double worst = 0;  // px, of a corner
  std::string worst_tag;
  std::map<int, Sum> of_tag;

  /// Of the corners of `view`, in the order of its tags.
  void add(const PanTiltView& view, const std::vector<double>& errors) {
    for (std::size_t i = 0; i < errors.size(); ++i) {
      const SeenTag& tag = view.tags[i / 4];
      Sum::add(errors[i]);
      of_tag[tag.id].add(errors[i]);
      if (errors[i] > worst)
        worst = errors[i], worst_tag = "tag " + std::to_string(tag.id) + " in the " +
                                       (tag.camera == 0 ? "left" : "right") + " picture of view " + view.name;
    }
  }

  /// Tags without which the rest is within `limit`, the worst first; nothing where they are more than a fourth of all.
  std::vector<int> moved(double limit) const {
    std::vector<std::pair<int, Sum>> tags(of_tag.begin(), of_tag.end());
    std::ranges::sort(tags, std::greater(), [](const auto& tag) { return tag.second.px(); });
    Sum rest = *this;
    std::vector<int> out;
    for (std::size_t i = 0; i < tags.size() / 4 && rest.px() > limit; ++i) {
      rest.squares -= tags[i].second.squares, rest.points -= tags[i].second.points;
      out.push_back(tags[i].first);
    }
    return rest.px() <= limit ? out : std::vector<int>{};
  }
};

std::string which(const std::vector<int>& tags) {
  std::vector<std::string> names;
  for (const int tag : tags) names.push_back(std::to_string(tag));
  return (tags.size() == 1 ? "tag " : "tags ") + joined(names);
}

struct PosedView {
  PanTiltView view;
  Pose T_world_left;  ///< by the encoders
};

/// Of a run as the registration sees it: the encoders with their play, at the calibrated offset.
std::vector<PosedView> by_encoders(const PanTiltVerify& options, const TagViews& all) {
  std::vector<PosedView> out;
  if (all.joints.empty()) {
    const PanTiltModel model = read_pan_tilt(read_result(options.result, "pan-tilt").result);
    for (const PanTiltView& view : all.views) out.push_back({view, camera_pose(model, view.angles)});
    return out;
  }
  const HeadModel head = read_head_model(options.result, options.time);
  EncoderTrack::Options track_options;
  track_options.kept_s = 1e9;
  EncoderTrack track(head, track_options);
  for (const JointRow& row : all.joints) track.add(row.time, {row.positions[0], row.positions[1]});
  for (std::size_t i = 0; i < all.views.size(); ++i)
    if (const auto at = track.at(all.times[i]); at.status != StateStatus::invalid)
      out.push_back({all.views[i], T_world_camera(head, at.shafts)});
  return out;
}

std::vector<DetectedTag> detected(const PanTiltView& view, int camera, const TagMap& of) {
  std::vector<DetectedTag> tags;
  for (const SeenTag& tag : view.tags)
    if (tag.camera == camera && of.contains(tag.id)) tags.push_back({tag.id, tag.pixels, 255});
  return tags;
}

/// Adds the errors of the tags outside of `correcting` after those in it have corrected the view; nothing where either
/// is missing.
void score_corrected(const PosedView& posed, const TagViews& all, const TagMap& correcting, const StereoLenses& lenses,
                     const TagCorrectionOptions& options, Score& score) {
  PanTiltView scored = posed.view;
  std::erase_if(scored.tags, [&](const SeenTag& tag) { return correcting.contains(tag.id); });
  TagCorrection correction(lenses, correcting, options);
  correction.add({}, posed.T_world_left, detected(posed.view, 0, correcting), detected(posed.view, 1, correcting));
  if (scored.tags.empty() || !correction.newest()) return;
  const TagCorrectionSummary found = correction.solve({});
  score.add(scored, corner_errors(all.cameras, posed.T_world_left * found.T_left_corrected, scored));
}

/// Leaves out the views that the result was solved from; where no other is there, they stay, and count against it.
void keep_unseen(const ViewPrints& known, TagViews& all, nlohmann::ordered_json& json, Verdict& verdict) {
  TagViews unseen = all;
  unseen.views.clear(), unseen.times.clear();
  for (std::size_t i = 0; i < all.views.size(); ++i) {
    const ViewPrints print = prints_of({all.views[i]});
    if (!print.empty() && knows(known, print.front())) continue;
    unseen.views.push_back(all.views[i]);
    if (!all.times.empty()) unseen.times.push_back(all.times[i]);
  }
  const std::size_t seen = all.views.size() - unseen.views.size();
  json["views_of_the_calibration"] = seen;
  if (seen == 0) return;
  if (2 * seen > all.views.size())
    verdict.object(std::to_string(seen) + " of " + std::to_string(all.views.size()) +
                       " views are among those that the result was solved from, and say nothing about others",
                   "record another run, and verify with it");
  if (2 * seen > all.views.size()) return;
  tell_seen(seen, all.views.size());
  all = std::move(unseen);
}

}  // namespace

int verify_head(const PanTiltVerify& options) {
  TagViews all = read_tag_views(options.input);
  Verdict verdict;
  nlohmann::ordered_json json;
  keep_unseen(read_result(options.result, "pan-tilt").header.views, all, json, verdict);
  const std::vector<PosedView> views = by_encoders(options, all);
  if (views.empty())
    throw InputError("--joints", "the encoders tell nothing of the times of the pictures",
                     "give the joints that were recorded with them");
  const StereoLenses lenses = to_lenses(all.cameras);
  TagMap correcting;
  for (auto tag = all.map.begin(); tag != all.map.end(); ++tag)
    if (std::distance(all.map.begin(), tag) % 2 == 0) correcting.insert(*tag);
  const TagCorrectionOptions correction = options_for(read_head_model(options.result, options.time)).correction;
  Score encoders, tags;
  for (const PosedView& posed : views) {
    encoders.add(posed.view, corner_errors(all.cameras, posed.T_world_left, posed.view));
    score_corrected(posed, all, correcting, lenses, correction, tags);
  }
  if (tags.points == 0)
    throw InputError("--tags", "no view shows two tags, one to correct and one to score",
                     "verify where more tags are in view");
  json["views"] = views.size();
  const auto row = [&](const char* name, const Score& score, double limit, const std::string& cure) {
    const bool good = score.px() <= limit;
    const std::vector<int> moved = good ? std::vector<int>{} : score.moved(limit);
    if (!moved.empty())
      verdict.object(std::string("the error by ") + name + " is above its limit, but not without " + which(moved),
                     moved.size() == 1
                         ? "it was moved, or the map is wrong: measure where it is, and correct --tags"
                         : "they were moved, or the map is wrong: measure where they are, and correct --tags");
    else if (!good)
      verdict.object(std::string("the error by ") + name + " is above its limit", cure);
    std::printf("%-9s %s  (limit %s, %s)  %s\n", name, readable(score.px(), 3, " px").c_str(),
                readable(limit, 3).c_str(), counted(score.points, "corner").c_str(), good ? "pass" : "FAIL");
    if (!good)
      std::printf("          worst: %s, %s\n", readable(score.worst, 1, " px").c_str(), score.worst_tag.c_str());
    json[std::string(name) + "_px"] = score.px();
    json[std::string(name) + "_worst_px"] = score.worst;
    json[std::string(name) + "_worst"] = score.worst_tag;
    json[std::string(name) + "_limit_px"] = limit;
  };
  row("encoders", encoders, options.encoders_px,
      "the head's zeros, axes or clock may have changed: calibrate it again (pan-tilt); --joints must be on the "
      "pictures' clock");
  row("tags", tags, options.tags_px,
      options.input.photometric
          ? "check that the map of the tags is that of what was in view, and the lenses (verify with a board)"
          : "bright and dark shift the corners of tags: give --photometric FILE of `foresight calibrate photometric`, "
            "here and to pan-tilt; else check the map of the tags");
  return tell_verified(verdict, views.size(), json, options.json);
}

}  // namespace foresight
