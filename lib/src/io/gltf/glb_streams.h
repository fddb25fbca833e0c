#pragma once

#include <tufa/io.h>
#include <tufa/mesh.h>
#include <array>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shading/shaded_mesh.h"

namespace tufa::io {

/// How a .glb stores positions, y up: an element is `factor` * (position - origin). The node
/// converts it to metres by its scale and translation.
struct GlbFrame {
  std::array<double, 3> origin{0, 0, 0};  ///< world units
  double factor = 1;
  double nodeScale = 1;                        ///< metres
  std::array<double, 3> translation{0, 0, 0};  ///< metres
  bool quantized = false;                      ///< elements are of 16 bits and not floats
  bool normalized = false;                     ///< those stand for 0 to 1
};

/// An array as it lies in the buffer.
struct GlbStream {
  std::string bytes;       ///< packed by EXT_meshopt_compression or not
  std::size_t stride = 0;  ///< bytes from element to element
  std::size_t count = 0;   ///< elements
  int componentType = 0;   ///< as glTF numbers them
  std::string type = "VEC3";
  bool normalized = false;  ///< whole numbers stand for 0 to 1 or -1 to 1
  /// Of positions and of their motions: the least and the greatest of each coordinate.
  std::optional<std::array<std::array<float, 3>, 2>> range = {};
};

/// A mesh as stored in a .glb.
struct GlbStreams {
  GlbFrame frame;
  GlbStream positions;
  GlbStream normals;                  ///< none if the mesh has none
  std::vector<GlbStream> attributes;  ///< in the mesh's order
  GlbStream indices;                  ///< of all parts, one after another
};

/// How meshes are stored.
struct GlbPacking {
  GlbCompression compression = GlbCompression::None;
  UpAxis up = UpAxis::Y;  ///< of the volume
  double scale = 1;       ///< metres in a world unit
};

/// The most that a number of 16 bits can be.
inline constexpr double kMostShort = 65535;

/// A point or direction of the volume, rotated so that y is up.
[[nodiscard]] std::array<double, 3> turned(const std::array<double, 3>& p, UpAxis up);
/// The other way.
[[nodiscard]] std::array<double, 3> turnedBack(const std::array<double, 3>& p, UpAxis up);

/// Where the positions of a frame are counted from, as the volume has it.
[[nodiscard]] Position originOf(const GlbFrame& frame, UpAxis up);

/// A frame in which floats, `factor` to a world unit, are counted from `origin`, y up.
[[nodiscard]] GlbFrame floatFrame(const std::array<double, 3>& origin, double factor,
                                  const GlbPacking& packing);

/// The frames to try for the meshes of a file. A mesh takes the first that keeps its vertices
/// apart.
[[nodiscard]] std::vector<GlbFrame> framesFor(std::span<const Mesh* const> meshes,
                                              const GlbPacking& packing);

/// Encodes a mesh in the first frame that keeps all its vertices apart and, in 16 bits, leaves an
/// area to all triangles that have one. Throws Error(LimitExceeded) if none does. Calls `check`
/// between its arrays, each of which takes a while, and throws what that throws.
[[nodiscard]] GlbStreams encode(const Mesh& mesh, const shading::ShadedMesh& shaded,
                                std::span<const GlbFrame> frames, const GlbPacking& packing,
                                const std::function<void()>& check);

/// Encodes a mesh in a frame, whatever becomes of its vertices.
[[nodiscard]] GlbStreams encodeIn(const GlbFrame& frame, const Mesh& mesh,
                                  const shading::ShadedMesh& shaded, const GlbPacking& packing);

}  // namespace tufa::io
