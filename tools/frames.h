#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tufa::tools {

// The names of the files of a sequence: #### stands for the frame's number, with zeros in front to
// as many digits, a sign among them: -001.

/// Whether a name has a place for a frame's number in its last part.
[[nodiscard]] bool namesFrames(const std::string& name);

/// With # for the digits of a frame's number, a name that has a place for it as other programs
/// write it: %04d, $F4; empty for any other.
[[nodiscard]] std::string framesInAnotherWay(const std::string& name);

/// Throws Error(InvalidArgument) if the last part of a name has several such places.
void requireOnePlace(const std::string& name);

/// The file of a frame.
[[nodiscard]] std::string frameFile(const std::string& name, int frame);

/// The frames that text means: "7", "1-240", "-10-240", "1-240x2" for every second one, and several
/// of these with commas between; rising, each once. Throws Error(InvalidArgument).
[[nodiscard]] std::vector<int> readFrames(const std::string& text);

/// With as many # as the numbers of the files have digits, if there are files of other frames than
/// the name asks for; else empty.
[[nodiscard]] std::string withDigitsOfFiles(const std::string& name);

/// The frames of which there are files, rising.
[[nodiscard]] std::vector<int> findFrames(const std::string& name);

}  // namespace tufa::tools
