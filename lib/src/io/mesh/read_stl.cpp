// .stl, text and binary.

#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/vertex_welder.h"
#include "io/mesh/mesh_builder.h"
#include "io/mesh/mesh_readers.h"

namespace tufa::io {
namespace {

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kPrefixBytes = kHeaderBytes + sizeof(std::uint32_t);
constexpr std::size_t kTriangleBytes = 50;

std::uint32_t claimedTriangles(const InputBytes& input) {
  std::uint32_t count = 0;
  std::memcpy(&count, input.view().data() + kHeaderBytes, sizeof count);
  return count;
}

std::size_t claimedBytes(const InputBytes& input) {
  return kPrefixBytes + kTriangleBytes * std::size_t{claimedTriangles(input)};
}

/// Text or binary? The first word does not tell, as many programs begin binary files with "solid".
/// The size does: that of a binary file follows from its count of triangles. So do zeros, which no
/// text has.
bool isText(const InputBytes& input) {
  if (input.size() >= kPrefixBytes && claimedBytes(input) == input.size()) return false;
  constexpr std::size_t kHead = 1000;
  const std::string_view text = withoutMark(input.view());
  if (text.substr(0, kHead).find('\0') != std::string_view::npos) return false;
  const std::size_t start = text.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && sameWord(text.substr(start, 5), "solid");
}

Mesh readBinary(const InputBytes& input) {
  if (input.size() < kPrefixBytes) input.fail("it is not an .stl file: too short");
  if (claimedBytes(input) > input.size()) {
    input.fail(std::to_string(claimedTriangles(input)) + " triangles need " +
               std::to_string(claimedBytes(input)) + " bytes, the file has " +
               std::to_string(input.size()) + ": truncated, or not an .stl file");
  }
  // Programs that are stopped while they write leave the count behind. A few bytes more are common.
  if (input.size() - claimedBytes(input) >= kTriangleBytes) {
    input.fail("it claims " + std::to_string(claimedTriangles(input)) +
               " triangles and has bytes for " +
               std::to_string((input.size() - kPrefixBytes) / kTriangleBytes));
  }
  Mesh mesh;
  base::VertexWelder welder(mesh.positions);
  mesh.triangles.reserve(claimedTriangles(input));
  for (std::size_t at = kPrefixBytes; at < claimedBytes(input); at += kTriangleBytes) {
    std::array<float, 12> numbers;  // the normal, then three corners
    std::memcpy(numbers.data(), input.view().data() + at, sizeof numbers);
    std::array<VertexIndex, 3> corners;
    for (std::size_t n = 0; n < 3; ++n) {
      const float* const p = numbers.data() + 3 * (n + 1);
      if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) {
        input.failAtByte(at + 12 * (n + 1), "a coordinate is not finite");
      }
      corners[n] = welder.indexOf({p[0], p[1], p[2]});
    }
    mesh.triangles.emplace_back(corners[0], corners[1], corners[2]);
  }
  return mesh;
}

Mesh readAscii(const InputBytes& input) {
  TextCursor text(input, 0, 1);
  MeshBuilder builder;
  base::VertexWelder welder(builder.mesh().positions);
  std::vector<std::uint64_t> corners;
  bool inSolid = false;
  while (text.nextLine()) {
    const std::string_view keyword = text.nextWord();
    if (keyword.empty()) continue;
    if (sameWord(keyword, "vertex")) {
      const double x = text.nextNumber();
      const double y = text.nextNumber();
      const double z = text.nextNumber();
      corners.push_back(welder.indexOf({x, y, z}));
    } else if (sameWord(keyword, "endloop")) {
      if (corners.size() < 3) text.fail("a loop has fewer than three vertices");
      builder.addFace(corners, builder.mesh().positions.size(),
                      [&](const std::string& cause) { text.fail(cause); });
      corners.clear();
    } else if (sameWord(keyword, "solid") || sameWord(keyword, "endsolid")) {
      inSolid = sameWord(keyword, "solid");
    } else if (!sameWord(keyword, "facet") && !sameWord(keyword, "outer") &&
               !sameWord(keyword, "endfacet")) {
      text.fail("neither facet, loop nor vertex");
    }
  }
  if (inSolid || !corners.empty()) text.fail("the file ends before \"endsolid\": truncated");
  return std::move(builder.mesh());
}

}  // namespace

Mesh readStl(const InputBytes& input) {
  return isText(input) ? readAscii(input) : readBinary(input);
}

}  // namespace tufa::io
