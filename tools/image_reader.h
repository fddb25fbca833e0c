#pragma once

#include <tufa/import.h>
#include <optional>
#include <string>
#include <vector>

namespace tufa::tools {

// Images of other programs are read by ITK, which can be left out of the command: with_images.cpp
// and without_images.cpp are the two ways to build it.

/// Throws Error(InvalidArgument) if the command was built without ITK.
void requireImageReader();

/// The help text of an option that needs ITK; says so if there is none.
[[nodiscard]] std::string imageHelp(const std::string& help);

/// Opens an image: one file with all of it, the files of its slices in their order, or a folder
/// with a DICOM series, `series` by its UID if there are several. World space is ITK's: x to the
/// left, y to the back, z up, for images of patients. Throws Error: UnreadableFile; InvalidArgument
/// for a folder of several series without a choice.
[[nodiscard]] ImageSlices openImage(const std::vector<std::string>& inputs,
                                    const std::optional<std::string>& series);

}  // namespace tufa::tools
