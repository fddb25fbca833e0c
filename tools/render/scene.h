#pragma once

#include <tufa/mesh.h>

#include <functional>
#include <vector>

#include "camera.h"
#include "image.h"

namespace tufa::render {

/// Gives the colours of points of a surface.
using SurfaceColors = std::function<std::vector<Color>(const std::vector<Position>& points)>;

/// How a picture is taken.
struct View {
  double azimuth = 35;    ///< degrees
  double elevation = 25;  ///< degrees
  /// World units from left to right; 0 fits the mesh.
  double width = 0;
  Vec3 centre{0, 0, 0};  ///< used if `width` is given
  bool yUp = false;      ///< the mesh's y axis points up, not z
  bool edges = false;    ///< draw the mesh's edges; a quad's diagonal is drawn lighter
  bool smooth = true;    ///< shade over edges flatter than 30 degrees; else one shade a triangle
  SurfaceColors colors;  ///< of the surface in place of its plain one; asked once a picture
};

/// The same view with the centre and width that fit a mesh into a picture: other meshes can then be
/// shown in the same view.
[[nodiscard]] View fitted(const Mesh& mesh, const View& view, int width, int height);

/// Takes a picture of a mesh on a light ground.
[[nodiscard]] Image render(const Mesh& mesh, const View& view, int width, int height);

}  // namespace tufa::render
