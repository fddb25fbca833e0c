#include <openvdb/openvdb.h>

#include <tufa/grid_files.h>
#include <tufa/memory.h>
#include <utility>

#include "io/grid/choose_grid.h"
#include "io/grid/vdb_leaves.h"
#include "io/grid/vdb_reader.h"

namespace tufa {

struct GridFile::State {
  template <class File>
  State(const File& file, const std::optional<std::string>& name)
      : reader(file), index(io::chooseGrid(reader, name)) {
    io::VdbReader::Topology topology = reader.readTopology(index);
    if (topology.grid) {
      grid = topology.grid;
      leaves = io::leavesOf(reader, std::move(topology));
    } else {
      load();
    }
  }

  void load() {
    grid = reader.readGrid(index);
    leaves.reset();
  }

  io::VdbReader reader;
  std::size_t index;
  openvdb::GridBase::Ptr grid;
  std::unique_ptr<base::LeafSource> leaves;
};

GridFile::GridFile(const std::filesystem::path& path, const std::optional<std::string>& name)
    : state_(std::make_unique<State>(path, name)) {}

GridFile::GridFile(const FileBytes& file, const std::optional<std::string>& name)
    : state_(std::make_unique<State>(file, name)) {}

GridFile::GridFile(GridFile&&) noexcept = default;
GridFile& GridFile::operator=(GridFile&&) noexcept = default;
GridFile::~GridFile() = default;

std::shared_ptr<const openvdb::GridBase> GridFile::outline() const { return state_->grid; }

bool GridFile::isLoaded() const { return state_->leaves == nullptr; }

std::shared_ptr<openvdb::GridBase> GridFile::load() {
  if (!isLoaded()) state_->load();
  return state_->grid;
}

base::LeafSource* GridFile::leaves() { return state_->leaves.get(); }

}  // namespace tufa
