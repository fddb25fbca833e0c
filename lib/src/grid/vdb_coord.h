#pragma once

#include <openvdb/Types.h>

#include "base/vec3.h"

// Between OpenVDB's coordinates and vectors and those of the library.

namespace tufa::grid {

inline openvdb::Coord toVdb(const Coord& c) { return {c[0], c[1], c[2]}; }
inline openvdb::Vec3d toVdb(const Vec3& v) { return {v[0], v[1], v[2]}; }
inline Coord fromVdb(const openvdb::Coord& c) { return {c[0], c[1], c[2]}; }
inline Vec3 fromVdb(const openvdb::Vec3d& v) { return {v[0], v[1], v[2]}; }

}  // namespace tufa::grid
