#include "failure.h"

#include <nlohmann/json.hpp>

#include <array>
#include <string_view>
#include <utility>

#include "commands.h"

namespace tufa::tools {
namespace {

using Words = std::pair<std::string_view, std::string_view>;

constexpr std::array kOptionsOfNames = {
    Words{"VoxelizeOptions::bandVoxels", "--band-voxels"},
    Words{"ContourOptions::tileFaces", "--tile-faces"},
    Words{"implicit::Field::extent()", "--bounds"},
    Words{"Method::MarchingCubes", "--method mc"},
    Words{"NonFinite::Outside", "--nan outside"},
};

}  // namespace

int exitCodeOf(const Error& error) {
  switch (error.code()) {
    case ErrorCode::InvalidArgument:
      return kWrongUsage;
    case ErrorCode::Cancelled:
      return kCancelled;
    default:
      return kUnusableFile;
  }
}

std::string messageOf(const Error& error) {
  std::string message = error.what();
  for (const auto& [name, option] : kOptionsOfNames) {
    const std::size_t at = message.find(name);
    if (at != std::string::npos) message.replace(at, name.size(), option);
  }
  return message;
}

std::string nameOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidArgument:
      return "invalid_argument";
    case ErrorCode::UnsupportedGrid:
      return "unsupported_grid";
    case ErrorCode::NonFiniteValues:
      return "non_finite_values";
    case ErrorCode::UnknownGrid:
      return "unknown_grid";
    case ErrorCode::UnreadableFile:
      return "unreadable_file";
    case ErrorCode::UnwritableFile:
      return "unwritable_file";
    case ErrorCode::LimitExceeded:
      return "limit_exceeded";
    case ErrorCode::Cancelled:
      return "interrupted";
  }
  return "unknown";
}

nlohmann::ordered_json errorToJson(const std::string& code, const std::string& message) {
  return {{"code", code}, {"message", message}};
}

}  // namespace tufa::tools
