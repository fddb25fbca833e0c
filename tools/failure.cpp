#include "failure.h"

#include <nlohmann/json.hpp>

#include "commands.h"

namespace tufa::tools {

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
