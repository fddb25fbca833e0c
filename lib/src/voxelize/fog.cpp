#include "voxelize/fog.h"

#include <openvdb/tools/LevelSetUtil.h>

namespace tufa::voxelize_field {

void toFog(openvdb::FloatGrid& grid) { openvdb::tools::sdfToFogVolume(grid); }

}  // namespace tufa::voxelize_field
