#pragma once

#include <openvdb/openvdb.h>

namespace tufa::voxelize_field {

/// A density of a level set: 1 inside, and less in the inner half of the band, down to 0 on the
/// surface.
void toFog(openvdb::FloatGrid& grid);

}  // namespace tufa::voxelize_field
