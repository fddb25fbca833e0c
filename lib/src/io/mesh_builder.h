#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tufa::io {

/// Gathers what a reader finds. Faces of more than four corners are fanned; faces of fewer than
/// three are points and lines, no part of a surface, and left out.
class MeshBuilder {
 public:
  /// Says why the file cannot be used; must throw.
  using Fail = std::function<void(const std::string& cause)>;

  void addPosition(const Position& position) { mesh_.positions.push_back(position); }

  /// A face by its corners, which are checked against the number of positions.
  void addFace(std::span<const std::uint64_t> corners, std::uint64_t positionCount,
               const Fail& fail);

  [[nodiscard]] Mesh& mesh() { return mesh_; }

 private:
  Mesh mesh_;
};

/// Gives equal positions one index: for formats that repeat them for every face.
class VertexWelder {
 public:
  explicit VertexWelder(std::vector<Position>& positions);

  /// The index of that position, which is added if it is new.
  [[nodiscard]] VertexIndex indexOf(Position position);

 private:
  void grow();
  [[nodiscard]] std::size_t slotOf(const Position& position) const;

  static constexpr VertexIndex kFree = 0xFFFFFFFF;
  std::vector<Position>& positions_;
  std::vector<VertexIndex> slots_;  ///< open addressing; a power of two, at most half full
};

}  // namespace tufa::io
