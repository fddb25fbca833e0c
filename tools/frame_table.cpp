#include "frame_table.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "console.h"

namespace tufa::tools {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array kStates = {"done", "empty", "missing", "skipped", "failed"};

std::string nameOfState(FrameState state) { return kStates[static_cast<std::size_t>(state)]; }

/// The reports of all grids of a frame: one of several is a list in the result.
std::vector<Json> gridsOf(const Json& result) {
  if (result.contains("grids")) return result["grids"].get<std::vector<Json>>();
  if (result.contains("triangles")) return {result};
  return {};
}

std::size_t sumOf(const Json& result, const char* key) {
  std::size_t sum = 0;
  for (const Json& grid : gridsOf(result)) sum += grid.value(key, std::size_t{0});
  return sum;
}

bool isWatertight(const Json& grid) {
  return !grid.contains("check") || grid["check"].value("watertight", true);
}

bool isSound(const Json& result) {
  const auto grids = gridsOf(result);
  return !result.contains("error") && std::all_of(grids.begin(), grids.end(), isWatertight);
}

/// The greatest certified error of a frame's meshes, in voxels; none of uniform meshes.
std::optional<double> errorOf(const Json& result) {
  std::optional<double> greatest;
  for (const Json& grid : gridsOf(result)) {
    if (!grid.contains("certificate")) continue;
    const double error = grid["certificate"].value("max_error_voxels", 0.0);
    greatest = std::max(error, greatest.value_or(error));
  }
  return greatest;
}

double secondsOf(const Json& result) {
  double sum = 0;
  for (const Json& grid : gridsOf(result)) {
    for (const char* part : {"read", "unite", "filter", "contour", "check", "write"}) {
      sum += grid["seconds"].value(part, 0.0);
    }
  }
  if (result.contains("grids")) sum += result["seconds"].value("write", 0.0);
  return sum;
}

/// Text as a field of a table with commas between.
std::string csvField(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

/// The files of a frame's grids, each once, with commas between; the name that was asked for if
/// there are none.
std::string outputsOf(const FrameRow& row) {
  std::string text, last;
  for (const Json& grid : gridsOf(row.result)) {
    const std::string output = grid.value("output", row.output);
    if (output != last) text += (last.empty() ? "" : ", ") + output;
    last = output;
  }
  return last.empty() ? row.output : text;
}

std::string describeMesh(const FrameRow& row) {
  const Json& result = row.result;
  std::string text = formatCount(sumOf(result, "triangles")) + " triangles";
  if (const auto error = errorOf(result)) text += ", within " + shortNumber(*error) + " voxels";
  if (const auto open = sumOf(result, "open_edges"); open > 0) {
    text += ", open at " + formatCount(open) + " lattice edges";
  }
  if (const auto wrong = sumOf(result, "non_finite_values"); wrong > 0) {
    text += ", " + formatCount(wrong) + " NaN or infinite values";
  }
  return text + ", " + shortNumber(secondsOf(result)) + " s: " + shownFile(outputsOf(row));
}

}  // namespace

std::string FrameRow::code() const {
  return result.contains("error") ? result["error"].value("code", "") : "";
}

std::string FrameRow::message() const {
  if (state != FrameState::Failed) return "";
  if (!result.contains("error")) return output + " is not watertight";
  const std::string text = result["error"].value("message", "");
  return text.find(file) == std::string::npos ? file + ": " + text : text;
}

const FrameRow& FrameTable::add(FrameRow row) {
  if (row.state == FrameState::Skipped && !isSound(row.result)) row.state = FrameState::Failed;
  if (row.state == FrameState::Done) {
    if (!isSound(row.result)) {
      row.state = FrameState::Failed;
    } else if (sumOf(row.result, "triangles") == 0) {
      row.state = FrameState::Empty;
    }
  }
  rows_.push_back(std::move(row));
  return rows_.back();
}

bool FrameTable::isEmpty() const {
  const std::size_t empty = count(FrameState::Empty);
  return empty > 0 && empty + count(FrameState::Missing) == rows_.size();
}

std::size_t FrameTable::count(FrameState state) const {
  return static_cast<std::size_t>(std::count_if(
      rows_.begin(), rows_.end(), [&](const FrameRow& row) { return row.state == state; }));
}

std::string FrameTable::describeLast() const {
  const FrameRow& row = rows_.back();
  std::string text = "[" + std::to_string(rows_.size()) + "/" + std::to_string(frames_) + "] " +
                     shownFile(row.file) + ": ";
  switch (row.state) {
    case FrameState::Done:
      return text + describeMesh(row) + "\n";
    case FrameState::Empty:
      return text + "no surface, an empty mesh: " + shownFile(outputsOf(row)) + "\n";
    case FrameState::Missing:
      return text + "missing\n";
    case FrameState::Skipped:
      return text + "skipped, its mesh is newer" +
             (row.result.contains("check") ? " and watertight: " : ": ") + shownFile(row.output) +
             "\n";
    case FrameState::Failed:
      return text + "failed" + (gridsOf(row.result).empty() ? "" : ": " + describeMesh(row)) + "\n";
  }
  return text;
}

std::string FrameTable::describe(double seconds) const {
  std::string text;
  for (std::size_t state = 0; state < kStates.size(); ++state) {
    const std::size_t frames = count(static_cast<FrameState>(state));
    if (frames == 0) continue;
    text += (text.empty() ? "" : ", ") + formatCount(frames) + " " + kStates[state];
  }
  return formatCount(rows_.size()) + " frames: " + text + ", in " + shortNumber(seconds) + " s\n";
}

Json FrameTable::toJson(double seconds) const {
  Json json;
  json["frames"] = Json::array();
  for (const FrameRow& row : rows_) {
    Json frame = {{"frame", row.number}, {"state", nameOfState(row.state)}};
    frame.update(row.result);
    frame["file"] = row.file;
    frame.emplace("output", row.output);  // of several grids each has its own
    json["frames"].push_back(std::move(frame));
  }
  for (std::size_t state = 0; state < kStates.size(); ++state) {
    json[kStates[state]] = count(static_cast<FrameState>(state));
  }
  json["seconds"] = seconds;
  return json;
}

std::string FrameTable::toCsv() const {
  std::string text =
      "frame,state,file,output,triangles,vertices,max_error_voxels,open_edges,seconds,message\n";
  for (const FrameRow& row : rows_) {
    const bool written = !gridsOf(row.result).empty();
    const auto number = [&](const std::string& value) { return written ? value : std::string(); };
    const auto error = errorOf(row.result);
    text += std::to_string(row.number) + "," + nameOfState(row.state) + "," + csvField(row.file) +
            "," + csvField(outputsOf(row)) + "," +
            number(std::to_string(sumOf(row.result, "triangles"))) + "," +
            number(std::to_string(sumOf(row.result, "vertices"))) + "," +
            (error ? formatNumber(*error) : "") + "," +
            number(std::to_string(sumOf(row.result, "open_edges"))) + "," +
            number(formatNumber(secondsOf(row.result))) + "," + csvField(row.message()) + "\n";
  }
  return text;
}

}  // namespace tufa::tools
