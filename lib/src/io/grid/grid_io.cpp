#include <openvdb/openvdb.h>

#include <tufa/error.h>
#include <tufa/io.h>
#include <tufa/memory.h>
#include <algorithm>
#include <ostream>

#include "base/parallel.h"
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

std::string listNames(const io::VdbReader& reader) {
  std::string names;
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    names += (n == 0 ? "\"" : ", \"") + reader.gridName(n) + "\"";
  }
  return names;
}

std::size_t findNamed(const io::VdbReader& reader, const std::string& name) {
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    if (reader.isNamed(n, name)) return n;
  }
  throw Error(ErrorCode::UnknownGrid,
              "no grid \"" + name + "\" in " + reader.name() + "; it holds " + listNames(reader));
}

std::size_t findMeshable(io::VdbReader& reader) {
  std::optional<std::size_t> found;
  std::string reasons;
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    const auto outline = reader.readOutline(n);
    const std::string whyNot = io::whyNotMeshable(*outline);
    if (!whyNot.empty()) {
      reasons += (reasons.empty() ? "\"" : "; \"") + reader.gridName(n) + "\": " + whyNot;
      continue;
    }
    if (outline->getGridClass() == openvdb::GRID_LEVEL_SET) return n;
    if (!found) found = n;
  }
  if (found) return *found;
  throw Error(ErrorCode::UnsupportedGrid,
              "no grid in " + reader.name() + " can be meshed (" + reasons + ")");
}

std::vector<GridName> listIn(io::VdbReader& reader) {
  std::vector<GridName> grids;
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    grids.push_back({reader.gridName(n), io::whyNotMeshable(*reader.readOutline(n)).empty()});
  }
  return grids;
}

openvdb::GridBase::Ptr readFrom(io::VdbReader& reader, const std::optional<std::string>& name) {
  if (reader.gridCount() == 0) {
    throw Error(ErrorCode::UnreadableFile, "cannot read " + reader.name() + ": it holds no grid");
  }
  if (!name) return reader.readGrid(findMeshable(reader));
  const std::size_t index = findNamed(reader, *name);
  // Of no use for anything: OpenVDB's own functions throw on such transforms.
  if (const std::string why = io::whyOutOfRange(*reader.readOutline(index)); !why.empty()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + *name + "\" in " + reader.name() + " cannot be meshed: " + why);
  }
  return reader.readGrid(index);
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
  return readFrom(reader, name);
}

openvdb::GridBase::Ptr readGrid(const FileBytes& file, const std::optional<std::string>& name) {
  io::VdbReader reader(file);
  return readFrom(reader, name);
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
