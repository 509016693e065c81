#include "seat/view_setup.hpp"

#include "common/error.hpp"
#include "sim/live_lab.hpp"

namespace foresight {
namespace {

/// What will be looked at, for the size of charts.
std::vector<ExpectedView> expected_views(const LiveScene& scene) {
  if (!scene.is_mock()) return {};
  const JointPositions at_rest = [](std::string_view joint) { return sim::shafts_at_rest(joint); };
  return {{scene.T_world_left(at_rest), scene.state_at({}, at_rest, StateStatus::predicted)}};
}

}  // namespace

ViewSetup live_view_setup(const LiveScene& scene, const std::string& where, const TextureOptions& textures,
                          const std::optional<LevelSettings>& levels) {
  if (!scene.lenses())
    throw InputError(where, "the cameras have no calibration", "give it as `lens` in the rig (docs/rig-files.md)");
  if (!scene.model())
    throw InputError(where, "there is no model of what the cameras see",
                     "give one as `scene:` in the rig, or with --scene");
  ViewSetup setup;
  setup.textures = textures;
  setup.levels = levels;
  setup.scene = scene.model();
  setup.left = scene.lenses()->left;
  setup.right = scene.lenses()->right;
  setup.surface = surface_for(*setup.scene, setup.left, expected_views(scene));
  setup.textures.depth_tolerance = setup.scene->accuracy().value_or(setup.textures.depth_tolerance);
  return setup;
}

void rehearse_for_real_time(ViewSetup& setup, const std::function<void(const std::string&)>& say,
                            const std::function<bool()>& stopped) {
  setup.rehearses = true;
  setup.goes_on = [say, stopped](std::size_t seen, std::size_t /*of*/) {
    if (seen == 0) say("the display's programs are made ready; without a GPU the first start takes 20 s");
    return !stopped();
  };
}

}  // namespace foresight
