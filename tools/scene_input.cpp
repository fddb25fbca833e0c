#include "scene_input.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "number_list.h"
#include "standard_streams.h"

namespace tufa::tools {

implicit::Scene readSceneInput(const std::string& name, const std::optional<std::string>& bounds) {
  std::optional<implicit::Box> box;
  if (bounds) {
    const auto n = numbersIn<6>("--bounds", *bounds);
    box = {Position(n[0], n[1], n[2]), Position(n[3], n[4], n[5])};
  }
  if (isStandard(name)) return implicit::readScene(standardInput(), box);
  return namingPipes(name, [&] { return implicit::readScene(std::filesystem::path(name), box); });
}

double voxelSizeFor(const implicit::Field& field) {
  constexpr double kVoxels = 100;
  const implicit::Box box = field.extent();
  const double longest = std::max(
      {box.greatest.x - box.least.x, box.greatest.y - box.least.y, box.greatest.z - box.least.z});
  // Where it has no end, voxelize() and makeRaySurface() say so.
  return std::isfinite(longest) && longest > 0 ? longest / kVoxels : 1;
}

}  // namespace tufa::tools
