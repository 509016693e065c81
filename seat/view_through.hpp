// A view that is made when it is first drawn, and made larger or smaller with its place.
#pragma once

#include <optional>

#include "display/view_session.hpp"

namespace foresight {

/// `view`, made if there is none, through `lens`, which differs in its size alone.
inline PredictedView& view_through(std::optional<PredictedView>& view, const ViewSession& session, const Lens& lens) {
  if (!view)
    view.emplace(session.make_view(lens));
  else
    view->set_lens(lens);
  return *view;
}

}  // namespace foresight
