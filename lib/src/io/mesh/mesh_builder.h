#pragma once

#include <tufa/mesh.h>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace tufa::io {

/// Collects what a reader finds. Faces of more than four corners are fanned; faces of fewer than
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

}  // namespace tufa::io
