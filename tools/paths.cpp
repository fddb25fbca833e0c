#include "paths.h"

#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <cstdint>
#include <system_error>

#include "console.h"
#include "standard_streams.h"

namespace tufa::tools {
namespace {

void requireFormat(MeshFormat format) {
  if (hasFormat(format)) return;
  throw Error(
      ErrorCode::InvalidArgument,
      "this tufa was built without lib3mf, which writes .3mf: install lib3mf-dev and configure "
      "with -DTUFA_USE_LIB3MF=ON, or write .stl or another format");
}

void requireEnding(const std::string& output, const std::string& what, const std::string& ending) {
  if (isStandard(output)) return;
  if (endingOf(output) != ending && !isPipeOrDevice(output)) {
    throw Error(ErrorCode::InvalidArgument,
                what + " is written as " + ending + ", which " + output + " does not end in");
  }
  requireWritable(output);
}

}  // namespace

bool isPipeOrDevice(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  return std::filesystem::exists(status) && std::filesystem::is_other(status);
}

bool sameFile(const std::filesystem::path& a, const std::filesystem::path& b) {
  // Nothing is lost in a pipe or a device that is read from and written to.
  if (isStandard(a) || isPipeOrDevice(a)) return false;
  std::error_code error;
  if (std::filesystem::equivalent(a, b, error) && !error) return true;
  return std::filesystem::weakly_canonical(std::filesystem::absolute(a, error), error) ==
         std::filesystem::weakly_canonical(std::filesystem::absolute(b, error), error);
}

void requireDistinct(const std::filesystem::path& output,
                     const std::vector<std::filesystem::path>& inputs) {
  const auto requireName = [](const std::filesystem::path& path, const char* what) {
    if (path.empty()) {
      throw Error(ErrorCode::InvalidArgument, std::string("the name of the ") + what + " is empty");
    }
  };
  requireName(output, "output");
  for (const std::filesystem::path& input : inputs) {
    requireName(input, "input");
    if (!sameFile(output, input)) continue;
    const std::string same = output == input ? "" : ", which is the same file as " + input.string();
    throw Error(ErrorCode::InvalidArgument,
                "the input would be overwritten by the output " + output.string() + same);
  }
}

void requireVolumeOutput(const std::string& output) { requireEnding(output, "a volume", ".vdb"); }

void requirePictureOutput(const std::string& output) { requireEnding(output, "a picture", ".png"); }

void requireMeshOutput(const std::string& output, const std::optional<std::string>& format) {
  requireFormat(meshFormat(output, format));
  if (!isStandard(output)) requireWritable(output);
}

void requireFile(const std::string& output, const std::string& what) {
  if (!isStandard(output)) return;
  throw Error(ErrorCode::InvalidArgument,
              what + " is written to a file, which standard output, -, is not");
}

void requirePageEnding(const std::filesystem::path& path) {
  const std::string ending = endingOf(path);
  if (ending == ".html" || ending == ".htm" || isPipeOrDevice(path)) return;
  throw Error(ErrorCode::InvalidArgument,
              "a page is written as .html, which " + path.string() + " does not end in");
}

std::string endingOf(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  });
  return ending;
}

std::string describeWritten(const std::vector<std::filesystem::path>& files, double seconds) {
  std::uintmax_t bytes = 0;
  for (const std::filesystem::path& file : files) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error) bytes += size;
  }
  std::string text = "wrote ";
  if (files.size() == 1) {
    text += isStandard(files.front()) ? "standard output" : shownFile(files.front());
  }
  if (files.size() == 2) text += shownFile(files.front()) + " and " + shownFile(files.back());
  if (files.size() > 2) {
    text += formatCount(files.size()) + " files, " + shownFile(files.front()) + " to " +
            shownFile(files.back());
  }
  if (bytes > 0) text += ", " + formatCount(bytes) + " bytes";
  return text + ", in " + shortNumber(seconds) + " s\n";
}

}  // namespace tufa::tools
