#include "chunks/chain/shaded_level.h"

#include <numeric>
#include <utility>

#include "chunks/chain/mixed_forms.h"
#include "shading/shaded_mesh.h"

namespace tufa::chunks {
namespace {

// Twice the area, along the normal.
Vec3 normalOf(const std::vector<Position>& positions, const Triangle& t) {
  const Vec3 a(positions[t.vertices[0]]);
  return (Vec3(positions[t.vertices[1]]) - a).cross(Vec3(positions[t.vertices[2]]) - a);
}

shading::ShadedMesh splitOf(const ChainLevel& level, double creaseAngle, base::Job& job) {
  Mesh mesh;
  mesh.positions = level.positions;
  mesh.normals = level.normals;
  mesh.triangles = level.triangles;
  return shading::splitAtCreases(mesh, creaseAngle, job);
}

}  // namespace

CurveNormals::CurveNormals(const std::vector<ChainLevel>& levels, double creaseAngle,
                           base::Job& job) {
  std::vector<std::pair<VertexIndex, Normal>> all;
  VertexIndex numbers = 0;  // those of a level's new places are above those of the level before
  for (const ChainLevel& level : levels) {
    const VertexIndex known = numbers;
    for (VertexIndex v = 0; v < level.own; ++v) {
      job.pollCancelled(v);
      const VertexIndex number = level.curveVertex[v];
      if (number != ChainLevel::kNone) numbers = std::max(numbers, number + 1);
    }
    if (numbers == known) continue;
    const shading::ShadedMesh split = splitOf(level, creaseAngle, job);
    for (std::size_t n = 0; n < split.sources.size(); ++n) {
      job.pollCancelled(n);
      const VertexIndex v = split.sources[n], number = level.curveVertex[v];
      const bool isNew = v < level.own && number != ChainLevel::kNone && number >= known;
      if (isNew) all.emplace_back(number, split.normals[n]);
    }
  }
  begin_.assign(numbers + 1, 0);
  for (const auto& [number, normal] : all) ++begin_[number + 1];
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  normals_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (const auto& [number, normal] : all) normals_[next[number]++] = normal;
}

std::size_t CurveNormals::nearest(VertexIndex v, const Vec3& face) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < countAt(v); ++i) {
    if (Vec3(at(v, i)).dot(face) > Vec3(at(v, best)).dot(face)) best = i;
  }
  return best;
}

ShadedLevel shade(const ChainLevel& level, const CurveNormals& curves, double creaseAngle,
                  base::Job& job) {
  shading::ShadedMesh split = splitOf(level, creaseAngle, job);
  ShadedLevel out{std::move(split.sources), std::move(split.normals), {}, {}};
  // Those of a vertex off the curves stand together.
  std::vector<VertexIndex> plain(level.positions.size() + 1, 0);
  for (const VertexIndex source : out.sources) ++plain[source + 1];
  std::partial_sum(plain.begin(), plain.end(), plain.begin());
  // The vertices of curves come behind, and those that the level's own creases gave them are used
  // by no triangle.
  std::vector<VertexIndex> first(level.positions.size(), ChainLevel::kNone);
  for (VertexIndex v = 0; v < level.positions.size(); ++v) {
    job.pollCancelled(v);
    const VertexIndex number = level.curveVertex[v];
    if (number == ChainLevel::kNone) continue;
    first[v] = static_cast<VertexIndex>(out.sources.size());
    for (std::size_t i = 0; i < curves.countAt(number); ++i) {
      out.sources.push_back(v);
      out.normals.push_back(curves.at(number, i));
    }
  }
  const auto cornerOf = [&](VertexIndex v, VertexIndex own, const Vec3& face) {
    if (level.curveVertex[v] != ChainLevel::kNone) {
      return first[v] + static_cast<VertexIndex>(curves.nearest(level.curveVertex[v], face));
    }
    if (out.sources[own] == v) return own;
    VertexIndex best = plain[v];
    for (VertexIndex n = best + 1; n < plain[v + 1]; ++n) {
      if (Vec3(out.normals[n]).dot(face) > Vec3(out.normals[best]).dot(face)) best = n;
    }
    return best;
  };
  out.triangles.resize(level.triangles.size());
  out.changed.resize(level.triangles.size());
  job.forRanges(level.triangles.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const Triangle forms[2] = {level.triangles[t], changed(level, level.triangles[t])};
      for (const bool isChanged : {false, true}) {
        const Triangle& form = forms[isChanged ? 1 : 0];
        const Vec3 face = normalOf(level.positions, form);
        Triangle& corners = (isChanged ? out.changed : out.triangles)[t];
        for (std::size_t i = 0; i < 3; ++i) {
          corners.vertices[i] = cornerOf(form.vertices[i], split.indices[3 * t + i], face);
        }
      }
    }
  });
  return out;
}

}  // namespace tufa::chunks
