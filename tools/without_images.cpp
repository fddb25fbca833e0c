// Stands for ITK in a command that is built without it.
#include <tufa/error.h>

#include "image_reader.h"

namespace tufa::tools {

void requireImageReader() {
  throw Error(ErrorCode::InvalidArgument,
              "this tufa was built without ITK and reads raw images alone, with --size; install "
              "libinsighttoolkit5-dev and configure with -DTUFA_USE_ITK=ON");
}

std::string imageHelp(const std::string& help) {
  return help + " (this tufa was built without ITK)";
}

ImageSlices openImage(const std::vector<std::string>& /*inputs*/,
                      const std::optional<std::string>& /*series*/) {
  requireImageReader();
  return {};
}

}  // namespace tufa::tools
