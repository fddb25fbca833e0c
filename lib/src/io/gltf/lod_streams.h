#pragma once

#include <tufa/lod.h>
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "io/mesh/shaded_mesh.h"

namespace tufa::io {

/// How a .glb stores positions, y up: an element is `factor` * (position - origin). The node
/// converts it to metres by its scale and translation.
struct LodFrame {
  std::array<double, 3> origin{0, 0, 0};  ///< world units
  double factor = 1;
  double nodeScale = 1;                        ///< metres
  std::array<double, 3> translation{0, 0, 0};  ///< metres
  bool quantized = false;  ///< elements are of 16 bits, which stand for 0 to 1, and not floats
};

/// An array as it lies in the buffer.
struct LodStream {
  std::string bytes;       ///< packed by EXT_meshopt_compression or not
  std::size_t stride = 0;  ///< bytes from element to element
  std::size_t count = 0;   ///< elements
  int componentType = 0;   ///< as glTF numbers them
  std::string type = "VEC3";
};

/// One LOD as stored in a .glb.
struct LodStreams {
  LodFrame frame;
  LodStream positions;
  LodStream normals;
  LodStream indices;
  std::vector<LodStream> attributes;  ///< in the mesh's order
  std::array<float, 3> least{};       ///< of the stored positions
  std::array<float, 3> greatest{};    ///< the same
};

/// The frames to try for the LODs of a chain. An LOD takes the first that keeps its vertices apart.
[[nodiscard]] std::vector<LodFrame> framesFor(const LodChain& chain,
                                              const LodWriteOptions& options);

/// Encodes an LOD in the first frame that keeps all its vertices apart and, in 16 bits, leaves an
/// area to all triangles that have one. Throws Error(LimitExceeded) if none does.
[[nodiscard]] LodStreams encodeLevel(const Mesh& mesh, const ShadedMesh& shaded,
                                     const std::vector<LodFrame>& frames,
                                     const LodWriteOptions& options);

}  // namespace tufa::io
