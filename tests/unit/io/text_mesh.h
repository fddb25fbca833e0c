#pragma once

#include <tufa/io.h>

#include <string>

#include "support/expect_error.h"
#include "support/scratch_folder.h"

namespace tufa::test {

/// The mesh of a file with this name, which chooses the format, and these bytes.
inline Mesh readText(const std::string& name, const std::string& text) {
  const ScratchFolder folder;
  writeBytes(folder / name, text);
  return readMesh(folder / name);
}

/// Expects that such a file is refused as unreadable, with `part` in the message.
inline void expectUnreadable(const std::string& name, const std::string& text,
                             const std::string& part) {
  expectError(ErrorCode::UnreadableFile, part, [&] { (void)readText(name, text); });
}

}  // namespace tufa::test
