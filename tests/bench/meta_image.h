#pragma once

#include <openvdb/openvdb.h>

#include <filesystem>

namespace tufa::bench {

/// A raw volume of unsigned 16-bit samples with a MetaImage header beside it. Throws
/// Error(UnreadableFile).
[[nodiscard]] openvdb::FloatGrid::Ptr readMetaImage(const std::filesystem::path& header);

}  // namespace tufa::bench
