#include "uniform/vertex_sheets.h"

#include <algorithm>

#include "base/huge_pages.h"

namespace tufa::uniform {
namespace {

// Sheets whose normals differ by less than this (18 degrees) are one.
constexpr double kSameSheet = 0.95;

}  // namespace

VertexSheets::VertexSheets(std::size_t vertices) {
  base::reserveLarge(kinds_, vertices);
  base::reserveLarge(outOfCell_, vertices);
  kinds_.resize(vertices, Kind::Smooth);
  outOfCell_.resize(vertices, 0);
}

void VertexSheets::setMeeting(VertexIndex vertex, const MeetingSheets& sheets) {
  if (entryOf_.empty()) {
    base::reserveLarge(entryOf_, kinds_.size());
    entryOf_.resize(kinds_.size(), 0);
  }
  std::uint32_t& entry = entryOf_[vertex];
  if (entry == 0) {
    entries_.emplace_back();
    entry = static_cast<std::uint32_t>(entries_.size());
  }
  entries_[entry - 1] = sheets;
  kinds_[vertex] = Kind::Meeting;
}

MeetingSheets VertexSheets::sheets(const Mesh& mesh, VertexIndex vertex) const {
  switch (kinds_[vertex]) {
    case Kind::Unknown:
      return {};
    case Kind::Meeting:
      return entries_[entryOf_[vertex] - 1];
    default:
      break;
  }
  if (mesh.normals.empty()) return {};
  MeetingSheets one;
  one.count = 1;
  one.normals[0] = mesh.normals[vertex];
  return one;
}

std::size_t VertexSheets::sharpCount() const {
  return static_cast<std::size_t>(
      std::count_if(kinds_.begin(), kinds_.end(), [](Kind k) { return k >= Kind::Meeting; }));
}

QuadSheets::QuadSheets(const Mesh& mesh, const VertexSheets& sheets, const Quad& quad) {
  for (int corner = 0; corner < 4; ++corner) {
    const MeetingSheets own = sheets.sheets(mesh, quad.vertices[corner]);
    if (own.count == 0) masks_[corner] = kAll;
    for (int i = 0; i < own.count; ++i) {
      const Vec3 normal(own.normals[i].x, own.normals[i].y, own.normals[i].z);
      int side = 0;
      while (side < count_ && normals_[side].dot(normal) < kSameSheet) ++side;
      if (side == count_) normals_[count_++] = normal;
      masks_[corner] |= 1U << side;
    }
  }
}

bool QuadSheets::isOneSheet(const Mesh& mesh, const VertexSheets& sheets, const Quad& quad) {
  const Normal& first = mesh.normals[quad.vertices[0]];
  return std::all_of(quad.vertices.begin(), quad.vertices.end(), [&](VertexIndex vertex) {
    const Normal& n = mesh.normals[vertex];
    return !sheets.isSharp(vertex) &&
           static_cast<double>(n.x * first.x + n.y * first.y + n.z * first.z) >= kSameSheet;
  });
}

bool QuadSheets::fits(bool secondDiagonal) const {
  const unsigned ends = secondDiagonal ? masks_[1] & masks_[3] : masks_[0] & masks_[2];
  const int a = secondDiagonal ? 0 : 1;
  return (ends & masks_[a]) != 0 && (ends & masks_[a + 2]) != 0;
}

}  // namespace tufa::uniform
