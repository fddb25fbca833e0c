#pragma once

#include <string>

namespace tufa::tools {

/// Throws Error if an image ends before its values do, or is packed and damaged, where ITK would
/// take what is missing for 0 or leave it out: NIfTI-1 (.nii, .nii.gz), packed MetaImage (.mha,
/// .mhd) and TIFF. `bytes` are those of all values.
void requireWholeImage(const std::string& file, double bytes);

}  // namespace tufa::tools
