#pragma once

#include <openvdb/openvdb.h>

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tufa::io {

/// Whether this build of Tufa reads .nvdb.
[[nodiscard]] bool hasNanoVdb();

/// All grids of the bytes of a NanoVDB file, as those of OpenVDB, with their names. Calls `fail`,
/// which throws, with what is wrong with the file.
[[nodiscard]] std::vector<openvdb::GridBase::Ptr> readNanoVdb(
    std::string_view bytes, const std::function<void(const std::string&)>& fail);

}  // namespace tufa::io
