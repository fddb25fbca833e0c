#pragma once

#include <string>

namespace tufa::tools {

/// Throws Error if an image ends before its values do, or is packed and damaged, where ITK would
/// take what is missing for 0 or leave it out: NIfTI-1 (.nii, .hdr and .img, packed or not), packed
/// MetaImage (.mha, .mhd) and NRRD (.nrrd, .nhdr), TIFF, and DICOM of values that are not packed.
/// `values` is how many it should have.
void requireWholeImage(const std::string& file, double values, double bytesOfEach);

}  // namespace tufa::tools
