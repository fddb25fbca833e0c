#pragma once

#include <tufa/mesh.h>

namespace tufa::chunks {

/// A vertex that was moved, or around which the surface was.
struct MovedVertex {
  VertexIndex vertex;
  double by;
};

}  // namespace tufa::chunks
