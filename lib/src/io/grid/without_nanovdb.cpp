// In place of nanovdb.cpp where there are no headers of NanoVDB.

#include "io/grid/nanovdb.h"

namespace tufa::io {

bool hasNanoVdb() { return false; }

std::vector<openvdb::GridBase::Ptr> readNanoVdb(
    std::string_view, const std::function<void(const std::string&)>& fail) {
  fail(
      "it is a NanoVDB file, which this build of Tufa does not read; nanovdb_convert makes a .vdb");
  return {};
}

}  // namespace tufa::io
