#include "texture_gpu/lamp/lamp_finder.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "common/real_time.hpp"

namespace foresight {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr std::size_t kWitnesses = 12000, kRecords = 48;
constexpr double kMoved = 5e-3, kTurned = 0.01;        // metres, radians: less is an error of a pose
constexpr double kNewMoved = 0.02, kNewTurned = 0.06;  // since the last record: less has much the same shadows
constexpr int kAnswerTakes = 2;                        // images
constexpr double kNextSearch = 1.25;                   // when there are so many times as many
constexpr int kNextAround = 2, kMostBetween = 192;     // likewise, of searches everywhere; records between them
constexpr float kDarkest = 0.02f;                      // of an image's values: below, noise and black level rule
const LampRecord::Value kNotKnown = LampRecord::Value::Constant(Eigen::half(std::numeric_limits<float>::quiet_NaN()));

}  // namespace

LampFinder::LampFinder(std::shared_ptr<const SceneModel> scene, bool awaits)
    : scene_(std::move(scene)), awaits_(awaits), rays_(*scene_) {
  for (const Node& node : scene_->nodes()) moving_.push_back(node.may_move);
}

bool LampFinder::look(const SceneState& state) {
  const auto far = [](const Pose& a, const Pose& b, double moved, double turned) {
    return (a.translation() - b.translation()).norm() > moved ||
           Eigen::AngleAxisd(a.linear().transpose() * b.linear()).angle() > turned;
  };
  ++looked_at_;
  if (search_.valid() && looked_at_ >= answer_at_ &&
      (awaits_ || search_.wait_for(Duration{0}) == std::future_status::ready))
    answer_ = search_.get();
  const auto& T = state.T_world_node;
  const bool is_first = first_.empty();
  if (is_first) first_ = last_ = T;
  bool differs = is_first, more = is_first && std::ranges::any_of(moving_, std::identity());
  for (std::size_t i = 0; i < T.size(); ++i) {
    differs = differs || far(T[i], last_[i], kNewMoved, kNewTurned);
    if (moving_[i] || !far(T[i], first_[i], kMoved, kTurned)) continue;
    moving_[i] = more = true;
  }
  if (!differs && !more) return false;
  last_ = T;
  if (more && witnesses_.empty()) choose();
  for (std::size_t i = 0; more && i < witnesses_.size(); ++i)  // what stood on it no longer tells anything
    if (moving_[static_cast<std::size_t>(witnesses_[i].node)])
      for (LampRecord& record : records_) record.log_brightness[i] = kNotKnown;
  return !witnesses_.empty();
}

void LampFinder::wait_for_search() const {
  if (search_.valid()) search_.wait();
}

void LampFinder::choose() {
  witnesses_ = choose_witnesses(*scene_, last_, moving_, kWitnesses);
  turned_.assign(witnesses_.size(), false);
  watch_.begin_anew();
  ++number_;
}

void LampFinder::add(const SceneState& state, const Vector3d& camera, std::span<const Vector3f> brightness) {
  LampRecord record{state.T_world_node, {}};
  for (std::size_t i = 0; i < witnesses_.size(); ++i) {
    Witness& w = witnesses_[i];
    const Vector3f& value = brightness[i];
    const bool known = value.minCoeff() > kDarkest && !moving_[static_cast<std::size_t>(w.node)];
    if (known && !turned_[i]) {
      turned_[i] = true;
      if (w.normal.dot(camera.cast<float>() - w.point) < 0) w.normal = -w.normal;
    }
    record.log_brightness.push_back(known ? LampRecord::Value(value.array().log().cast<Eigen::half>()) : kNotKnown);
  }
  records_.push_back(std::move(record));
  if (records_.size() > kRecords) records_.pop_front();
  ++recorded_;
  if (search_.valid()) return;
  watch();
  if (recorded_ >= ask_at_) ask();
}

/// Once the light has become another, what was recorded before tells nothing of it, and all begins anew.
void LampFinder::watch() {
  if (!answer_.lamp) return watch_.begin_anew();
  watch_.look(rays_, witnesses_, records_.back(), moving_, *answer_.lamp);
  const int against = watch_.against();
  if (against == 0) return;
  records_.erase(records_.begin(), records_.end() - against);
  recorded_ = against;
  ask_at_ = look_around_at_ = 0;
  answer_ = {};
  watch_.begin_anew();
}

void LampFinder::ask() {
  LampQuestion question{witnesses_, records_, moving_, answer_, recorded_ >= look_around_at_};
  ask_at_ = std::min(static_cast<int>(std::ceil(kNextSearch * recorded_)), recorded_ + static_cast<int>(kRecords));
  if (question.all_around) look_around_at_ = std::min(kNextAround * recorded_, recorded_ + kMostBetween);
  answer_at_ = looked_at_ + kAnswerTakes;
  search_ = std::async(std::launch::async, [this, question = std::move(question)] {
    make_background();  // frames and images go first
    return find_lamp(rays_, question);
  });
}

}  // namespace foresight
