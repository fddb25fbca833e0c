#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "support/mesh_oracle.h"
#include "support/model.h"

namespace tufa::refine::test_ring {

inline constexpr double kVoxel = 0.5;

/// A ring that needs cells of several sizes.
inline openvdb::FloatGrid::Ptr ring() {
  return test::levelSetOf(26, kVoxel, [](const Vec3& p) {
    return std::hypot(std::hypot(p[0], p[1]) - 14.3, p[2]) - 6.2;
  });
}

/// Expects the topology of a ring.
inline void expectRing(const Mesh& mesh) {
  const test::MeshTopology topology = test::inspect(test::triangulated(mesh));
  EXPECT_TRUE(topology.closed() && topology.manifold()) << topology;
  EXPECT_EQ(topology.euler(), 0);
  EXPECT_EQ(topology.components, 1U);
}

}  // namespace tufa::refine::test_ring
