#pragma once

#include <cstddef>

namespace tufa::base {

/// The values of a tree's leaves, where these are not in memory. For one thread at a time.
class LeafSource {
 public:
  virtual ~LeafSource() = default;

  /// Writes the 512 values of a leaf, floats or doubles as the tree has them. Leaves are counted in
  /// the order of the tree. Throws Error(UnreadableFile).
  virtual void read(std::size_t leaf, void* values) = 0;
};

}  // namespace tufa::base
