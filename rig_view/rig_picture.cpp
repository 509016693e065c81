#include "rig_view/rig_picture.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "rig_view/words.hpp"

namespace foresight {
namespace {

const Colour kNoLink{0.80f, 0.78f, 0.72f, 1};
const Colour kLinks[] = {{0.70f, 0.73f, 0.77f, 1}, {0.58f, 0.61f, 0.66f, 1}};  // neighbours tell apart

/// A bar of a round length in the lower left corner, true at the target's distance.
void draw_scale(cv::Mat& picture, const Eye& eye) {
  const double per_pixel = eye.metres_per_pixel(picture.rows);
  double length = 0.01;
  for (const double next : {0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0})
    if (next / per_pixel < 0.25 * picture.cols) length = next;
  const int px = cvRound(length / per_pixel), y = picture.rows - 16;
  const cv::Scalar ink(40, 32, 26);
  cv::line(picture, {16, y}, {16 + px, y}, ink, 2, cv::LINE_AA);
  for (const int x : {16, 16 + px}) cv::line(picture, {x, y - 5}, {x, y + 5}, ink, 2, cv::LINE_AA);
  const std::string where = eye.perspective ? ", in the middle's distance" : "";
  put_text(picture, fmt::format("{:g} m{}; floor squares 0.1 m", length, where), {16, y - 11}, 0.42, ink);
}

}  // namespace

RigPicture::RigPicture(const RigBody& body) : pass_(body.nodes().model()) {
  for (const Node& node : body.nodes().nodes())
    is_link_.push_back(body.rig().robot && std::ranges::any_of(body.rig().robot->links, [&](const Node& link) {
                         return link.name == node.name;
                       }));
}

cv::Mat RigPicture::operator()(const RigBody& body, const PlacedRig& placed, const PanelState& state, const Eye& eye,
                               int width, int height) {
  const int wide = width - kPanelWidth;
  const Drawing drawing = draw_rig(body, placed, state.positions, state.layers, state.selected);
  std::vector<Colour> colours;
  std::size_t links = 0;
  for (std::size_t i = 0; i < is_link_.size(); ++i) {
    Colour colour = is_link_[i] ? kLinks[links % std::size(kLinks)] : kNoLink;
    if (is_link_[i] && !body.nodes().nodes()[i].mesh.triangles.empty()) ++links;
    if (is_link_[i] && !shows(state.layers, Layer::links)) colour[3] = 0;
    colours.push_back(colour);
  }
  cv::Mat whole(height, width, CV_8UC3);
  cv::Mat scene = pass_(eye, wide, height, placed.T_world_node, colours, drawing);
  write_words(scene, drawing.words, eye);
  draw_scale(scene, eye);
  scene.copyTo(whole(cv::Rect(0, 0, wide, height)));
  draw_panel(whole(cv::Rect(wide, 0, kPanelWidth, height)), body.rig(), state, placed);
  return whole;
}

}  // namespace foresight
