// The page of `tufa compare`.

#include <tufa/error.h>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/vec3.h"
#include "compare_run.h"
#include "console.h"
#include "html.h"
#include "render/scene.h"

namespace tufa::tools {
namespace {

using render::View;

constexpr int kWidth = 640;
constexpr int kHeight = 480;
constexpr double kCloseUp = 12;  ///< voxels from left to right

/// Looks at a point of the surface aslant, so that steps show.
View closeUpOf(const Comparison& all, const View& whole) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  constexpr double kSlant = 25;
  View view = whole;
  view.edges = true;
  view.smooth = false;
  view.width = kCloseUp * all.voxelSize;
  view.centre = Vec3(*all.differsAt);
  const Vec3 eye = Vec3(all.outward);
  if (eye.squaredLength() == 0) return view;
  // Pictures have the y axis up; see Camera::looking().
  view.azimuth = std::atan2(eye[0], eye[2]) * kDegrees + kSlant;
  view.elevation =
      std::clamp(std::asin(std::clamp(eye[1], -1.0, 1.0)) * kDegrees + kSlant, -80.0, 80.0);
  return view;
}

/// The triangles around a point, so that nothing stands in front of it.
Mesh partAround(const Mesh& mesh, const Vec3& centre, double radius) {
  Mesh part;
  part.positions = mesh.positions;
  const auto isNear = [&](const auto& face) {
    return std::any_of(face.vertices.begin(), face.vertices.end(), [&](VertexIndex vertex) {
      return (Vec3(mesh.positions[vertex]) - centre).squaredLength() < radius * radius;
    });
  };
  std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(part.triangles),
               isNear);
  std::copy_if(mesh.quads.begin(), mesh.quads.end(), std::back_inserter(part.quads), isNear);
  return part;
}

std::string section(const Comparison& all, const MethodResult& result, const View& view) {
  std::string html = element(
      "h2", escaped(result.name) + ": " + formatCount(result.check.triangles) + " triangles");
  html += "<div class=\"row\">\n" +
          figure(render::render(result.mesh, view, kWidth, kHeight), "surface");
  if (all.differsAt) {
    const Mesh part = partAround(result.mesh, Vec3(*all.differsAt), kCloseUp * all.voxelSize);
    html += figure(render::render(part, closeUpOf(all, view), kWidth, kHeight),
                   "where the methods differ most");
  }
  return html + "</div>\n";
}

}  // namespace

std::string pageOf(const CompareRun& run, const CompareArguments& arguments,
                   const Progress& progress) {
  const Comparison& all = run.comparison;
  const TableRows rows = tableOf(all);
  std::string html = pageHead("Methods for " + shownGrid(run.gridName), summaryOf(run, arguments)) +
                     table(rows.front(), {rows.begin() + 1, rows.end()});
  if (all.differsAt) {
    html +=
        element("p", "The methods differ most, by " + shortNumber(all.difference) + " voxels, at " +
                         formatNumber(all.differsAt->x) + ", " + formatNumber(all.differsAt->y) +
                         ", " + formatNumber(all.differsAt->z) + ".");
  }
  View view;
  view.yUp = true;
  view = render::fitted(all.methods.front().mesh, view, kWidth, kHeight);
  for (std::size_t i = 0; i < all.methods.size(); ++i) {
    const double done = static_cast<double>(i) / static_cast<double>(all.methods.size());
    if (progress && !progress("pictures", done)) {
      throw Error(ErrorCode::Cancelled, "cancelled while taking pictures");
    }
    html += section(all, all.methods[i], view);
  }
  return html + pageEnd();
}

}  // namespace tufa::tools
