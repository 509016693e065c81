#include "apps/calibrate/arm_verify.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/calibrate/outputs.hpp"
#include "calibration/camera/rig.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {

int verify_arm(const ArmVerify& options) {
  const ResultFile file = read_result(options.result, "arm");
  ArmViews views = read_arm_views(options.input);
  const ViewPrints prints = prints_of(views.data.corners);
  std::vector<std::size_t> unseen;
  for (std::size_t v = 0; v < prints.size(); ++v)
    if (!knows(file.header.views, prints[v])) unseen.push_back(v);
  Verdict verdict;
  nlohmann::ordered_json json{{"views_of_the_calibration", prints.size() - unseen.size()}};
  if (unseen.empty())
    verdict.object("all views are among those that the result was solved from, and say nothing about others",
                   "take new pictures, and verify with these");
  else
    views = some_views(views, unseen);
  std::map<std::string, double> offsets;
  if (file.result.has("joint_offsets")) {
    const YamlMap map = file.result.map("joint_offsets");
    for (const std::string& joint : map.keys()) offsets[joint] = map.number(joint);
  }
  const HandEyeScore score = score_hand_eye(read_hand_eye(file.result), with_poses(views, offsets));
  const double limit = options.px.value_or(kWorseThanScore * file.header.score);
  const bool good = score.px <= limit;
  std::printf("robot     %s  (limit %s)  %s\n", readable(score.px, 3, " px").c_str(), readable(limit, 3).c_str(),
              good ? "pass" : "FAIL");
  std::printf("          %s; worst view %s, %s\n", readable(score.mm, 2, " mm").c_str(), score.worst.c_str(),
              readable(score.worst_px, 2, " px").c_str());
  json["views"] = score.views;
  json["robot_px"] = score.px, json["robot_mm"] = score.mm, json["robot_limit_px"] = limit;
  json["worst_view"] = score.worst, json["worst_px"] = score.worst_px;
  if (!good)
    verdict.object("the robot puts the board elsewhere than the pictures do",
                   "the camera or the arm's foot may have moved, or the board on the flange: where the board was put "
                   "there anew, no old result holds; calibrate again (arm)");
  return tell_verified(verdict, static_cast<std::size_t>(score.views), json, options.json);
}

}  // namespace foresight
