#include "chunks/chain/shaded_level.h"

#include <array>
#include <cmath>
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

constexpr double kRadians = 3.14159265358979323846 / 180;

class LevelShader {
 public:
  LevelShader(const ChainLevel& level, const CurveNormals& curves, double creaseAngle,
              const CurveSides& beyond, base::Job& job)
      : level_(level),
        curves_(curves),
        leastCosine_(std::cos(creaseAngle * kRadians)),
        beyond_(beyond),
        job_(job),
        split_(splitOf(level, creaseAngle, job)) {}

  [[nodiscard]] ShadedLevel shade() {
    out_ = {std::move(split_.sources), std::move(split_.normals), {}, {}, {}};
    placeVertices();
    const std::size_t count = level_.triangles.size();
    out_.triangles.resize(count);
    out_.changed.resize(count);
    job_.forRanges(count, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        out_.triangles[t] = ownCorners(t);
        out_.changed[t] = changedCorners(t);
      }
    });
    addSides();
    return std::move(out_);
  }

 private:
  // Those of a vertex off the curves stand together. The vertices of curves come behind, and those
  // that the level's own creases gave them are used by no triangle.
  void placeVertices() {
    plain_.assign(level_.positions.size() + 1, 0);
    for (const VertexIndex source : out_.sources) ++plain_[source + 1];
    std::partial_sum(plain_.begin(), plain_.end(), plain_.begin());
    first_.assign(level_.positions.size(), ChainLevel::kNone);
    for (VertexIndex v = 0; v < level_.positions.size(); ++v) {
      job_.pollCancelled(v);
      if (!isOnCurve(v)) continue;
      first_[v] = static_cast<VertexIndex>(out_.sources.size());
      for (std::size_t i = 0; i < curves_.countAt(level_.curveVertex[v]); ++i) {
        out_.sources.push_back(v);
        out_.normals.push_back(curves_.at(level_.curveVertex[v], i));
      }
    }
  }

  [[nodiscard]] bool isOnCurve(VertexIndex v) const {
    return level_.curveVertex[v] != ChainLevel::kNone;
  }

  [[nodiscard]] VertexIndex nearest(VertexIndex v, const Vec3& direction) const {
    if (isOnCurve(v)) {
      return first_[v] +
             static_cast<VertexIndex>(curves_.nearest(level_.curveVertex[v], direction));
    }
    VertexIndex best = plain_[v];
    for (VertexIndex n = best + 1; n < plain_[v + 1]; ++n) {
      if (Vec3(out_.normals[n]).dot(direction) > Vec3(out_.normals[best]).dot(direction)) best = n;
    }
    return best;
  }

  // The faces of a smooth group take the normal nearest to their common one, and so the same on
  // both sides of a plane.
  [[nodiscard]] VertexIndex ownCorner(std::size_t t, std::size_t corner) const {
    const VertexIndex v = level_.triangles[t].vertices[corner];
    const VertexIndex group = split_.indices[3 * t + corner];
    return isOnCurve(v) ? nearest(v, Vec3(out_.normals[group])) : group;
  }

  [[nodiscard]] Triangle ownCorners(std::size_t t) const {
    return {ownCorner(t, 0), ownCorner(t, 1), ownCorner(t, 2)};
  }

  [[nodiscard]] Triangle changedCorners(std::size_t t) const {
    const Triangle &own = level_.triangles[t], form = changed(level_, own);
    Triangle corners = out_.triangles[t];
    if (form == own) return corners;
    const Vec3 face = normalOf(level_.positions, form);
    for (std::size_t i = 0; i < 3; ++i) {
      if (form.vertices[i] == own.vertices[i]) continue;
      corners.vertices[i] = nearest(form.vertices[i], face);
    }
    takeFromBeyond(form, level_.chunkOf[t], face.unitOrX(), corners);
    return corners;
  }

  // Where a triangle meets one of the next LOD smoothly, at an edge, both have the same normals at
  // its ends: those that the other one has beside its own LOD.
  void takeFromBeyond(const Triangle& form, std::uint32_t chunk, const Vec3& face,
                      Triangle& corners) const {
    std::array<double, 3> cosines;
    cosines.fill(leastCosine_);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::array<std::size_t, 2> ends = {i, (i + 1) % 3};
      const VertexIndex a = form.vertices[ends[0]], b = form.vertices[ends[1]];
      if (!isOnCurve(a) || !isOnCurve(b)) continue;
      const CurveSides::Side* side = beyond_.find(level_.curveVertex[b], level_.curveVertex[a]);
      if (side == nullptr || side->chunk == chunk) continue;
      const double cosine = side->face.dot(face);
      for (const std::size_t end : {0U, 1U}) {
        if (cosine < cosines[ends[end]]) continue;
        cosines[ends[end]] = cosine;
        corners.vertices[ends[end]] = first_[form.vertices[ends[end]]] + side->normals[1 - end];
      }
    }
  }

  void addSides() {
    for (std::size_t t = 0; t < level_.triangles.size(); ++t) {
      job_.pollCancelled(t);
      const auto& v = level_.triangles[t].vertices;
      const Vec3 face = normalOf(level_.positions, level_.triangles[t]).unitOrX();
      for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        if (!isOnCurve(v[i]) || !isOnCurve(v[j])) continue;
        const auto numberAt = [&](std::size_t corner) {
          return out_.triangles[t].vertices[corner] - first_[v[corner]];
        };
        out_.sides.add(level_.curveVertex[v[i]], level_.curveVertex[v[j]],
                       {level_.chunkOf[t], face, {numberAt(i), numberAt(j)}});
      }
    }
  }

  const ChainLevel& level_;
  const CurveNormals& curves_;
  double leastCosine_;
  const CurveSides& beyond_;
  base::Job& job_;
  shading::ShadedMesh split_;
  ShadedLevel out_;
  std::vector<VertexIndex> plain_;  ///< for each vertex the first of its own, off the curves
  std::vector<VertexIndex> first_;  ///< for each vertex of a curve the first of its normals
};

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

std::size_t CurveNormals::nearest(VertexIndex v, const Vec3& direction) const {
  std::size_t best = 0;
  for (std::size_t i = 1; i < countAt(v); ++i) {
    if (Vec3(at(v, i)).dot(direction) > Vec3(at(v, best)).dot(direction)) best = i;
  }
  return best;
}

ShadedLevel shade(const ChainLevel& level, const CurveNormals& curves, double creaseAngle,
                  const CurveSides& beyond, base::Job& job) {
  return LevelShader(level, curves, creaseAngle, beyond, job).shade();
}

}  // namespace tufa::chunks
