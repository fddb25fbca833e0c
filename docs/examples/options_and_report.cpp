// What contour() can be asked for and what it tells: options, progress, the report, and the check.

#include <tufa/check.h>
#include <tufa/tufa.h>

#include <iostream>

int main() {
  try {
    const openvdb::FloatGrid::Ptr fog = tufa::makeShape(tufa::Shape::Fog);

    tufa::ContourOptions options;
    options.isovalue = 0.5;                           // in the grid's own unit
    options.inside = tufa::Inside::Above;             // a density: the solid is where there is more
    options.ambiguity = tufa::Ambiguity::Asymptotic;  // how ambiguous cell faces are joined
    options.tolerance = 0.05;                         // voxels; the default is 0.1
    options.threads = 2;                              // never changes the result
    options.progress = [](std::string_view stage, double fraction) {
      std::clog << stage << " " << static_cast<int>(100 * fraction) << " %\r";
      return true;  // false would end the call with ErrorCode::Cancelled
    };

    tufa::ContourReport report;
    const tufa::Mesh mesh = tufa::contour(*fog, options, &report);
    std::cout << report.surfaceCells << " surface cells of " << report.activeVoxels << " voxels\n";
    if (report.certificate) {
      std::cout << "at most " << report.certificate->maxErrorVoxels
                << " voxels off the uniform mesh\n";
    }
    for (const tufa::StageTime& time : report.stages) {
      std::cout << "  " << time.stage << ": " << time.seconds << " s\n";
    }

    // The checker lives in Tufa::check, which links CGAL and falls under the GPL.
    const tufa::CheckReport check = tufa::check(mesh);
    std::cout << check.components.size() << " pieces, " << check.selfIntersectingPairs.value_or(0)
              << " intersecting pairs, " << (check.watertight() ? "watertight" : "not watertight")
              << "\n";
    return check.watertight() ? 0 : 1;
  } catch (const tufa::Error& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
}
