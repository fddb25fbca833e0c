#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tufa::tools {

/// What became of a frame.
enum class FrameState {
  Done,     ///< its mesh was written
  Empty,    ///< there is no surface: an empty mesh was written
  Missing,  ///< there is no volume
  Skipped,  ///< its mesh is newer than its volume
  Failed,   ///< no mesh was written, or it is not as it should be
};

/// What there is to tell of a frame.
struct FrameRow {
  int number = 0;
  std::string file;
  std::string output;
  FrameState state = FrameState::Done;
  nlohmann::ordered_json result;  ///< as `tufa mesh --json` prints it, or its "error"

  /// Of its error; empty if there is none.
  [[nodiscard]] std::string code() const;
  /// What is wrong, for people; names the file.
  [[nodiscard]] std::string message() const;
};

/// The frames of a sequence, row by row.
class FrameTable {
 public:
  explicit FrameTable(std::size_t frames) : frames_(frames) {}

  /// Adds a frame; what its result says is put into its state.
  const FrameRow& add(FrameRow row);

  /// A line about the frame added last.
  [[nodiscard]] std::string describeLast() const;
  /// A line about all.
  [[nodiscard]] std::string describe(double seconds) const;
  [[nodiscard]] nlohmann::ordered_json toJson(double seconds) const;
  /// A line of headings, and one for each frame.
  [[nodiscard]] std::string toCsv() const;

  /// Whether any frame has failed.
  [[nodiscard]] bool failed() const { return count(FrameState::Failed) > 0; }
  /// Whether there are frames, and none of them has a surface.
  [[nodiscard]] bool isEmpty() const;

 private:
  [[nodiscard]] std::size_t count(FrameState state) const;

  std::size_t frames_;
  std::vector<FrameRow> rows_;
};

}  // namespace tufa::tools
