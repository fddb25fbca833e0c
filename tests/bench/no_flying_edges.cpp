#include "flying_edges.h"

namespace tufa::bench {

std::function<FlyingEdgesMesh(int)> flyingEdgesOf(const openvdb::FloatGrid&, double) { return {}; }

}  // namespace tufa::bench
