// Sections 4.3 and 4.5.3: the perspective texture seen at right angles, in the resolution of eqs. 4.28 and 4.29.
#pragma once

#include "texture_gpu/thesis/perspective_texture.hpp"
#include "texture_gpu/thesis/polygon_textures.hpp"

namespace foresight::thesis {

/// Belongs to one context.
class Normalisation {
 public:
  /// Makes room for textures of up to max_texture x max_texture texels.
  explicit Normalisation(int max_texture);

  /// Draws the bounding box's quadrilateral in the polygon's plane (eqs. 4.30 to 4.39) into texture();
  /// alpha becomes 1 where more than 31/32 arrives, else 0. The thesis finds the quadrilateral's
  /// corners by intersecting their rays with the plane; here each texel asks where it projects to,
  /// which is the same mapping, and holds where a corner looks past the horizon of the plane.
  void operator()(const PerspectiveTexture& perspective, const BoundingBox& box, const PolygonFrame& frame,
                  const Pose& T_camera_node, const gl::Faces& plane, const TexelDrawing& drawing) const;

  /// The same without the measures of section 4.5.3: only the polygon itself is drawn, and what is
  /// half transparent counts as visible (figure 4.15).
  void polygon_only(const PerspectiveTexture& perspective, const BoundingBox& box, const Polygon& polygon,
                    const PolygonFrame& frame, const Pose& T_camera_node, const gl::Faces& plane,
                    const TexelDrawing& drawing) const;

  const gl::Texture& texture() const { return texture_; }

 private:
  void bind(const gl::Program& program, const PerspectiveTexture& perspective, const BoundingBox& box,
            const PolygonFrame& frame, const Pose& T_camera_node, const gl::Faces& plane) const;

  gl::Texture texture_;
  gl::Program box_, polygon_;
};

}  // namespace foresight::thesis
