// Whether pictures cross a thin line at half their width and height.
//
// Bytes per picture have a floor at each size: what moves has to be said somehow. Near the floor of whole pictures,
// halved ones look better, for the same bytes, and their floor is a third. How much has to be said is judged by how
// many places have changed since the last pair, so that a scene in which little moves stays sharp on the thinnest line.
#pragma once

#include <cstddef>
#include <opencv2/core.hpp>

#include "link/coding/planes.hpp"

namespace foresight {

/// One thread.
class PictureScale {
 public:
  /// Of the next pair, `planes` of full size, for which `bytes` are wished. A change costs a picture that is predicted
  /// from none, so it waits until the wish has been for it a while.
  bool halved(const Planes& planes, std::size_t bytes);

 private:
  double changed(const Planes& planes);

  bool halved_ = false;
  int for_change_ = 0;  // pairs in a row that would be better at the other size
  double moving_ = 1;   // share of the places that change between pairs, smoothed
  cv::Mat seen_;        // the last pair's places
};

}  // namespace foresight
