#include "io/grid/vdb_leaves.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace tufa::io {
namespace {

template <class GridT>
class VdbLeaves final : public base::LeafSource {
  using Leaf = typename GridT::TreeType::LeafNodeType;

 public:
  VdbLeaves(VdbReader& reader, VdbReader::Topology topology)
      : reader_(reader), grid_(std::move(topology.grid)), places_(std::move(topology.leafPlaces)) {
    static_cast<GridT&>(*grid_).tree().getNodes(leaves_);
  }

  void read(std::size_t leaf, void* values) override {
    Leaf& target = *leaves_[leaf];
    reader_.readAt(places_[leaf], *grid_,
                   [&](std::istream& stream, bool isHalf) { target.readBuffers(stream, isHalf); });
    std::copy_n(target.buffer().data(), Leaf::SIZE,
                static_cast<typename GridT::ValueType*>(values));
    typename Leaf::Buffer none(openvdb::PartialCreate(), typename GridT::ValueType(0));
    target.swap(none);
  }

 private:
  VdbReader& reader_;
  openvdb::GridBase::Ptr grid_;
  std::vector<Leaf*> leaves_;
  std::vector<std::uint64_t> places_;  ///< of each leaf's buffers in the file
};

}  // namespace

std::unique_ptr<base::LeafSource> leavesOf(VdbReader& reader, VdbReader::Topology topology) {
  if (topology.grid->isType<openvdb::FloatGrid>()) {
    return std::make_unique<VdbLeaves<openvdb::FloatGrid>>(reader, std::move(topology));
  }
  return std::make_unique<VdbLeaves<openvdb::DoubleGrid>>(reader, std::move(topology));
}

}  // namespace tufa::io
