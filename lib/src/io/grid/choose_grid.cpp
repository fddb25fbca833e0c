#include "io/grid/choose_grid.h"

#include <openvdb/openvdb.h>

#include <tufa/error.h>

#include "io/grid/grid_traits.h"

namespace tufa::io {
namespace {

std::string listNames(const VdbReader& reader) {
  std::string names;
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    names += (n == 0 ? "\"" : ", \"") + reader.gridName(n) + "\"";
  }
  return names;
}

std::size_t findNamed(const VdbReader& reader, const std::string& name) {
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    if (reader.isNamed(n, name)) return n;
  }
  throw Error(ErrorCode::UnknownGrid,
              "no grid \"" + name + "\" in " + reader.name() + "; it holds " + listNames(reader));
}

std::size_t findMeshable(VdbReader& reader) {
  std::optional<std::size_t> found;
  std::string reasons;
  for (std::size_t n = 0; n < reader.gridCount(); ++n) {
    const auto outline = reader.readOutline(n);
    const std::string whyNot = whyNotMeshable(*outline);
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

}  // namespace

std::size_t chooseGrid(VdbReader& reader, const std::optional<std::string>& name) {
  if (reader.gridCount() == 0) {
    throw Error(ErrorCode::UnreadableFile, "cannot read " + reader.name() + ": it holds no grid");
  }
  if (!name) return findMeshable(reader);
  const std::size_t index = findNamed(reader, *name);
  // Of no use for anything: OpenVDB's own functions throw on such transforms.
  if (const std::string why = whyOutOfRange(*reader.readOutline(index)); !why.empty()) {
    throw Error(ErrorCode::UnsupportedGrid,
                "grid \"" + *name + "\" in " + reader.name() + " cannot be meshed: " + why);
  }
  return index;
}

}  // namespace tufa::io
