// What a view of a live scene needs, before its first image.
#pragma once

#include "display/view_session.hpp"
#include "session/live_scene.hpp"

namespace foresight {

/// With charts of a size that suits the cameras' own views. Throws InputError where lenses or model are not known,
/// naming `where`. `textures`: their depth_tolerance is the model's, where that states one; `levels`:
/// ViewSetup::levels.
ViewSetup live_view_setup(const LiveScene& scene, const std::string& where, const TextureOptions& textures = {},
                          const std::optional<LevelSettings>& levels = std::nullopt);

/// ViewSetup::rehearses, until `stopped`, which is asked before each of its images; and says that it takes a while.
void rehearse_for_real_time(ViewSetup& setup, const std::function<void(const std::string&)>& say,
                            const std::function<bool()>& stopped);

}  // namespace foresight
