#include <tufa/check.h>
#include <tufa/tufa.h>

int main() {
  tufa::ShapeOptions options;
  options.voxelSize = 0.1;
  const tufa::Mesh mesh = tufa::contour(*tufa::makeShape(tufa::Shape::Torus, options));
  return tufa::check(mesh).watertight() ? 0 : 1;
}
