#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/memory.h>
#include <algorithm>
#include <ostream>

#include "base/parallel.h"
#include "io/grid/choose_grid.h"
#include "io/grid/grid_traits.h"
#include "io/grid/vdb_reader.h"
#include "io/output_file.h"

namespace tufa {
namespace {

/// Opens up the writing of openvdb::io::Archive to any stream: openvdb::io::File does not notice a
/// full disk.
class VdbWriter : private openvdb::io::Archive {
 public:
  void writeTo(std::ostream& stream, const openvdb::GridCPtrVec& grids, bool seekable) const {
    Archive::write(stream, grids, seekable);
  }
};

std::vector<GridName> listIn(io::VdbReader& reader) {
  std::vector<GridName> grids;
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    grids.push_back({reader.gridName(n), io::whyNotMeshable(*reader.readOutline(n)).empty()});
  }
  return grids;
}

void requireGrids(const std::vector<openvdb::GridBase::ConstPtr>& grids) {
  if (std::find(grids.begin(), grids.end(), nullptr) == grids.end()) return;
  throw Error(ErrorCode::InvalidArgument, "one of the grids to write is null");
}

void writeTo(io::OutputFile& file, const std::vector<openvdb::GridBase::ConstPtr>& grids) {
  openvdb::initialize();
  io::OutputFileBuffer buffer(file);
  std::ostream stream(&buffer);
  stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
  // OpenVDB counts voxels in parallel for the metadata.
  base::runIsolated([&] { VdbWriter().writeTo(stream, grids, file.seekable()); });
  file.commit();
}

/// Calls write(), and gives what OpenVDB and streams throw the name of what was written to.
template <class Write>
void namingErrors(const std::string& target, Write&& write) {
  try {
    write();
  } catch (const openvdb::Exception& error) {
    throw Error(ErrorCode::UnwritableFile, "cannot write " + target + ": " + error.what());
  } catch (const std::ios_base::failure& error) {
    throw Error(ErrorCode::UnwritableFile, "cannot write " + target + ": " + error.what());
  }
}

}  // namespace

std::vector<GridName> listGrids(const std::filesystem::path& path) {
  io::VdbReader reader(path);
  return listIn(reader);
}

std::vector<GridName> listGrids(const FileBytes& file) {
  io::VdbReader reader(file);
  return listIn(reader);
}

openvdb::GridBase::Ptr readGrid(const std::filesystem::path& path,
                                const std::optional<std::string>& name) {
  io::VdbReader reader(path);
  return reader.readGrid(io::chooseGrid(reader, name));
}

openvdb::GridBase::Ptr readGrid(const FileBytes& file, const std::optional<std::string>& name) {
  io::VdbReader reader(file);
  return reader.readGrid(io::chooseGrid(reader, name));
}

void writeGrids(const std::vector<openvdb::GridBase::ConstPtr>& grids,
                const std::filesystem::path& path) {
  requireGrids(grids);
  namingErrors(path.string(), [&] {
    io::OutputFile file(path);
    writeTo(file, grids);
  });
}

void writeGrids(const std::vector<openvdb::GridBase::ConstPtr>& grids, std::ostream& stream) {
  requireGrids(grids);
  namingErrors("the stream", [&] {
    io::OutputFile file(stream);
    writeTo(file, grids);
  });
}

void requireWritable(const std::filesystem::path& path) { io::requireWritablePath(path); }

}  // namespace tufa
