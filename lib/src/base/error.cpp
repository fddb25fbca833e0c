#include <tufa/error.h>
#include <tufa/version.h>

#include "base/printable.h"

namespace tufa {

Error::Error(ErrorCode code, const std::string& message)
    : std::runtime_error(base::printable(message)), code_(code) {}

const char* version() noexcept { return TUFA_VERSION; }

}  // namespace tufa
