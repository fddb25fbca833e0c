#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "io/grid/vdb_reader.h"

namespace tufa::io {

/// The grid of a file with that name, or, without one, the first level set that can be meshed, else
/// the first grid that can be meshed. Throws Error as tufa::readGrid().
[[nodiscard]] std::size_t chooseGrid(VdbReader& reader, const std::optional<std::string>& name);

}  // namespace tufa::io
