#pragma once

#include <tufa/mesh.h>
#include <vector>

namespace tufa::base {

/// Gives equal positions one index: for meshes whose faces repeat positions.
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

}  // namespace tufa::base
