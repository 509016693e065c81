#include "prediction/sighting/thing_finder.hpp"

#include <algorithm>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "common/error.hpp"

namespace foresight {
namespace {

constexpr std::size_t kCandidates = 16;
constexpr double kBesideHand = 0.008;    // m: starts of a fit about a thing in the hand
constexpr double kLeastUncovered = 0.7;  // share of the surface, before anything is said to be missing
constexpr double kNotThere = 2.6;        // of the largest difference: what is seen there is something else
constexpr double kOwn = 0.6;             // of a thing's radius: nearer, two things are at one place
// Of what rests on something: it does so, at the height that is known, and level.
const Eigen::Vector3d kRestPlace(0.03, 0.03, 0.0015), kRestTurn(0.02, 0.02, 0.2);
const Eigen::Vector3d kHeldPlace(0.02, 0.02, 0.02), kHeldTurn(0.15, 0.15, 0.15);
const std::vector<double> kTurns = {0, 0.26, -0.26, 0.52, -0.52, 0.78, -0.78};

bool fits(const PosedImage& image, const Lens& lens) {
  return image.pixels.cols == lens.width() && image.pixels.rows == lens.height() &&
         (image.pixels.type() == CV_8UC1 || image.pixels.type() == CV_8UC3);
}

cv::Mat grey_of(const cv::Mat& pixels) {
  if (pixels.channels() == 1) return pixels;
  cv::Mat out;
  cv::cvtColor(pixels, out, cv::COLOR_BGR2GRAY);
  return out;
}

double lowest(const ThingShape& shape, const Eigen::Matrix3d& R) {
  double out = 0;
  for (const Eigen::Vector3d& v : shape.vertices()) out = std::min(out, (R * v).z());
  return out;
}

/// On each of its sides, turned over a quarter at a time; its lowest point where that of `rested` is.
std::vector<Pose> on_all_sides(const ThingShape& shape, const Pose& rested) {
  std::vector<Pose> out{rested};
  const double ground = rested.translation().z() + lowest(shape, rested.linear());
  for (const auto& axis : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitY()})
    for (const double quarter : {0.5, -0.5, 1.0}) {
      if (quarter == 1.0 && axis.y() == 1) continue;  // upside down is once enough
      Pose T = rested;
      T.linear() = rested.linear() * Eigen::AngleAxisd(quarter * std::numbers::pi, Eigen::Vector3d(axis));
      T.translation().z() = ground - lowest(shape, T.linear());
      out.push_back(T);
    }
  return out;
}

}  // namespace

struct ThingFinder::Looked {
  std::vector<EdgePicture> pictures;
  std::vector<FrontDepth> fronts;
  std::vector<SeenBy> cameras;
};

ThingFinder::ThingFinder(std::shared_ptr<const SceneModel> model, std::vector<SoughtThing> things,
                         const StereoLenses& lenses, const ThingFinderOptions& options)
    : model_(std::move(model)),
      lenses_(lenses),
      options_(options),
      rays_{CoarseRays(lenses.left), CoarseRays(lenses.right)} {
  for (const SoughtThing& sought : things) {
    ThingShape shape(model_->nodes().at(sought.node).mesh);
    SurfaceColours colours(shape.surface().size());
    for (const Thing& other : things_)
      if (sought.tag && other.tag && sought.tag->id == other.tag->id)
        throw InputError("the tag " + std::to_string(sought.tag->id), "is on two things", "give each a tag of its own");
    if (sought.tag && !tags_) tags_ = std::make_unique<TagDetector>(TagDetector::Options{});
    things_.push_back({sought.node, sought.tag, std::move(shape), std::move(colours), std::nullopt});
  }
}

ThingSighting ThingFinder::sighting(std::size_t thing, RobotTime captured, const Pose& T,
                                    const Matrix6d& covariance) const {
  const auto sigma = [](double variance, double floor) { return std::sqrt(variance + floor * floor); };
  return {thing, captured, T, sigma(covariance.bottomRightCorner<3, 3>().trace() / 3, options_.floor_m),
          sigma(covariance.topLeftCorner<3, 3>().trace() / 3, options_.floor_rad)};
}

void ThingFinder::find_tags(const PosedFrame& frame, std::vector<bool>& done, FoundThings& out) {
  if (!tags_) return;
  std::vector<DetectedTag> left = tags_->detect(grey_of(frame.left.pixels)), right;
  std::vector<TagsSeenBy> cameras{{&lenses_.left, frame.left.T_world_camera, &left}};
  if (frame.right && fits(*frame.right, lenses_.right)) {
    right = tags_->detect(grey_of(frame.right->pixels));
    cameras.push_back({&lenses_.right, frame.right->T_world_camera, &right});
  }
  for (std::size_t i = 0; i < things_.size(); ++i) {
    const auto fit = things_[i].tag ? fit_tag(*things_[i].tag, cameras) : std::nullopt;
    if (!fit) continue;
    const ThingSighting seen = sighting(i, frame.left.time, fit->T_world_thing, fit->covariance);
    if (seen.sigma > options_.most_sigma) continue;
    out.sightings.push_back(seen);
    done[i] = true;
  }
}

std::optional<ThingFinder::Fit> ThingFinder::agreeing(const Thing& thing, const Looked& looked, const Pose& start,
                                                      bool held) const {
  const StartSigma sigma = held ? StartSigma{kHeldPlace, kHeldTurn} : StartSigma{kRestPlace, kRestTurn};
  Fit out;
  if (thing.colours.known()) {
    const auto fit = thing.colours.fit(thing.shape, thing.node, looked.cameras, start, sigma);
    if (!fit) return std::nullopt;
    const bool in_place = !held && (fit->T_world_thing.translation() - start.translation()).norm() < options_.in_place;
    if (fit->difference > (in_place ? options_.most_difference_in_place : options_.most_difference))
      return std::nullopt;
    out = {fit->T_world_thing, fit->covariance, -fit->difference};
  } else {
    const auto fit = fit_edges(thing.shape, thing.node, looked.cameras, start, {sigma});
    if (!fit || fit->agreement < options_.least_agreement) return std::nullopt;
    out = {fit->T_world_thing, fit->covariance, fit->agreement};
  }
  if (!(out.covariance.bottomRightCorner<3, 3>().trace() / 3 < options_.most_sigma * options_.most_sigma))
    return std::nullopt;
  if (!((out.T_world_thing.translation() - start.translation()).norm() < options_.farthest)) return std::nullopt;
  out.in_hand = held;
  return out;
}

/// Elsewhere than expected: beside where the hand holds it, where it last was, on the ground below the hand.
std::optional<ThingFinder::Fit> ThingFinder::search(const Thing& thing, const Looked& looked,
                                                    const ExpectedThing& expected) const {
  std::optional<Fit> best;
  const auto consider = [&](const Pose& start, bool held) {
    auto fit = agreeing(thing, looked, start, held);
    if (fit && thing.colours.known() && -fit->worth > options_.found_difference) return;
    if (fit && (!best || fit->worth > best->worth)) best = std::move(fit);
  };
  if (expected.held) {
    for (int k = 0; k < 6; ++k) {
      Pose start = expected.T_world_thing;
      start.translation()[k / 2] += k % 2 ? kBesideHand : -kBesideHand;
      consider(start, true);
    }
    if (best) return best;
  }
  const Pose rested = thing.rested.value_or(expected.T_world_thing);
  std::vector<Pose> middles = {expected.held ? rested : expected.T_world_thing};
  if (expected.held) {
    Pose below = rested;
    below.translation().head<2>() = expected.T_world_thing.translation().head<2>();
    middles.push_back(below);
  }
  for (const bool turned_over : {false, true}) {
    for (const Pose& middle : middles) {
      const std::vector<Pose> sides = on_all_sides(thing.shape, middle);
      for (std::size_t k = turned_over ? 1 : 0; k < (turned_over ? sides.size() : 1); ++k) {
        SearchWindow window{sides[k], options_.search_reach, 0.006, kTurns};
        for (const Pose& start :
             likely_poses(thing.shape, thing.node, thing.colours, looked.cameras, window, kCandidates))
          consider(start, false);
      }
      if (best) return best;
    }
    if (!thing.colours.known()) break;  // of what nobody saw yet, colours say nothing
  }
  return best;
}

bool ThingFinder::taken_by_another(const Thing& thing, const Pose& T, const FoundThings& found) const {
  return std::ranges::any_of(found.sightings, [&](const ThingSighting& other) {
    const Eigen::Vector3d there = other.T_world_thing * things_[other.thing].shape.middle();
    return (T * thing.shape.middle() - there).norm() < kOwn * thing.shape.radius();
  });
}

bool ThingFinder::is_missing(const Thing& thing, const Looked& looked, const Pose& expected) const {
  if (!thing.colours.known() || uncovered_share(thing.shape, thing.node, looked.cameras, expected) < kLeastUncovered)
    return false;
  const auto difference = thing.colours.difference(thing.shape, thing.node, looked.cameras, expected);
  return difference && *difference > kNotThere * options_.most_difference;
}

FoundThings ThingFinder::look(const PosedFrame& frame, std::span<const ExpectedThing> expected) {
  FoundThings out;
  if (expected.size() != things_.size() || !fits(frame.left, lenses_.left)) return out;
  std::vector<bool> done(things_.size(), false);
  find_tags(frame, done, out);
  if (std::ranges::all_of(done, std::identity())) return out;
  Looked looked;
  looked.pictures.reserve(2);
  looked.fronts.reserve(2);
  const auto add = [&](const PosedImage& image, const Lens& lens, const CoarseRays& rays) {
    looked.pictures.emplace_back(image.pixels);
    looked.fronts.emplace_back(rays, *model_, frame.left.scene, image.T_world_camera);
    looked.cameras.push_back({&lens, image.T_world_camera, &looked.pictures.back(), &looked.fronts.back()});
  };
  add(frame.left, lenses_.left, rays_[0]);
  if (frame.right && fits(*frame.right, lenses_.right)) add(*frame.right, lenses_.right, rays_[1]);
  const auto accept = [&](std::size_t i, const Fit& fit) {
    Thing& thing = things_[i];
    out.sightings.push_back(sighting(i, frame.left.time, fit.T_world_thing, fit.covariance));
    if (!expected[i].held && !fit.in_hand) thing.rested = fit.T_world_thing;
    thing.colours.learn(thing.shape, thing.node, looked.cameras, fit.T_world_thing);
    done[i] = true;
  };
  for (std::size_t i = 0; i < things_.size(); ++i) {
    if (done[i] || expected[i].moving) continue;
    auto fit = agreeing(things_[i], looked, expected[i].T_world_thing, expected[i].held);
    if (expected[i].in_hand)
      if (auto other = agreeing(things_[i], looked, *expected[i].in_hand, true);
          other && (!fit || other->worth > fit->worth))
        fit = std::move(other);
    if (fit && !taken_by_another(things_[i], fit->T_world_thing, out)) accept(i, *fit);
  }
  for (std::size_t k = 0; k < things_.size(); ++k) {  // one search a frame: the others have their turn with the next
    const std::size_t i = (next_search_ + k) % things_.size();
    if (done[i] || expected[i].moving) continue;
    next_search_ = i + 1;
    const auto fit = search(things_[i], looked, expected[i]);
    if (fit && !taken_by_another(things_[i], fit->T_world_thing, out))
      accept(i, *fit);
    else if (is_missing(things_[i], looked, expected[i].T_world_thing))
      out.missing.push_back(i);
    break;
  }
  return out;
}

}  // namespace foresight
