#pragma once

#include <cstdint>
#include <string>

namespace tufa::io {

/// Throws DamagedGrid unless OpenVDB, reading a piece of metadata of that type, takes all bytes of
/// `value` and no more, and makes no more room than a file of `fileBytes` has a use for.
void requireSoundMetadata(const std::string& type, const std::string& value,
                          std::uint64_t fileBytes);

}  // namespace tufa::io
