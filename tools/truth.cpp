#include "truth.h"

#include <tufa/shapes.h>

namespace tufa::tools {

std::vector<std::string> namesOfTruths() {
  std::vector<std::string> names;
  for (const std::string_view name : shapeNames()) {
    if (name != "noise" && name != "fog") names.emplace_back(name);
  }
  return names;
}

void setTruth(const std::string& shape, double voxelSize, CompareOptions& options) {
  const Shape known = *shapeByName(shape);
  options.truth = [known](const Position& point) { return shapeDistance(known, point); };
  options.truthPoints = shapeCreasePoints(known, voxelSize / 4);
}

}  // namespace tufa::tools
