// The files of frames are read line by line: write() puts a prim's name, an attribute or a brace on
// each line, and nothing else between the braces of a mesh. Where values lie is noted, and they are
// copied as they are, attribute by attribute, as USD keeps all samples of one together.

#include "usda_sequence.h"

#include <tufa/error.h>
#include <tufa/io.h>
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "base/number_text.h"
#include "console.h"

namespace tufa::tools {
namespace {

/// A value in the file of a frame; nothing if the frame has none.
struct Place {
  std::uint64_t begin = 0;
  std::uint64_t size = 0;
};

/// An attribute of a mesh over all frames.
struct SampledAttribute {
  std::string declaration;    ///< such as "point3f[] points"
  std::string metadata;       ///< such as "interpolation = "vertex""; empty if it has none
  int metadataFrame = 0;      ///< the first with values, which said so
  std::vector<Place> places;  ///< one for each frame
};

/// A mesh over all frames.
struct SampledMesh {
  std::string head;                  ///< such as "def Mesh "smoke""
  std::vector<std::string> uniform;  ///< lines of what never changes
  std::vector<SampledAttribute> attributes;
};

[[noreturn]] void failToRead(const std::filesystem::path& file) {
  throw Error(ErrorCode::UnreadableFile, "cannot read " + file.string());
}

std::string_view withoutIndent(std::string_view line) {
  return line.substr(std::min(line.find_first_not_of(' '), line.size()));
}

/// What is found in the files of the frames.
class Frames {
 public:
  explicit Frames(const std::vector<UsdaFrame>& frames) : frames_(frames) {
    for (std::size_t i = 0; i < frames.size(); ++i) read(i);
  }

  [[nodiscard]] const std::vector<std::string>& head() const { return head_; }
  [[nodiscard]] const std::vector<SampledMesh>& meshes() const { return meshes_; }

 private:
  void read(std::size_t frame) {
    std::ifstream stream(frames_[frame].file, std::ios::binary);
    SampledMesh* mesh = nullptr;
    std::string line;
    for (std::uint64_t begin = 0; std::getline(stream, line); begin += line.size() + 1) {
      const std::string_view text = withoutIndent(line);
      if (text.starts_with("def Mesh ")) {
        mesh = &meshOf(text);
      } else if (mesh == nullptr) {
        if (frame == 0) head_.push_back(line);
      } else if (text.starts_with("uniform ")) {
        addUniform(*mesh, text);
      } else if (text.find(" = ") != std::string_view::npos) {
        addValue(*mesh, text, begin + (line.size() - text.size()), frame);
      }
    }
    if (!stream.eof()) failToRead(frames_[frame].file);
  }

  SampledMesh& meshOf(std::string_view head) {
    const auto found = std::find_if(meshes_.begin(), meshes_.end(),
                                    [&](const SampledMesh& mesh) { return mesh.head == head; });
    if (found != meshes_.end()) return *found;
    return meshes_.emplace_back(SampledMesh{std::string(head), {}, {}});
  }

  static void addUniform(SampledMesh& mesh, std::string_view line) {
    if (std::find(mesh.uniform.begin(), mesh.uniform.end(), line) != mesh.uniform.end()) return;
    mesh.uniform.emplace_back(line);
  }

  /// `begin`: of the line's text in its file.
  void addValue(SampledMesh& mesh, std::string_view line, std::uint64_t begin, std::size_t frame) {
    const std::size_t equals = line.find(" = ");
    const std::string_view declaration = line.substr(0, equals), value = line.substr(equals + 3);
    const auto nameOf = [](std::string_view text) { return text.substr(text.rfind(' ') + 1); };
    for (const SampledAttribute& other : mesh.attributes) {
      if (other.declaration == declaration || nameOf(other.declaration) != nameOf(declaration)) {
        continue;
      }
      throw Error(ErrorCode::InvalidArgument,
                  "one .usda cannot hold " + other.declaration + " and, in frame " +
                      std::to_string(frames_[frame].number) + ", " + std::string(declaration));
    }
    auto attribute = std::find_if(
        mesh.attributes.begin(), mesh.attributes.end(),
        [&](const SampledAttribute& other) { return other.declaration == declaration; });
    if (attribute == mesh.attributes.end()) {
      mesh.attributes.push_back({std::string(declaration), "", 0, {}});
      mesh.attributes.back().places.resize(frames_.size());
      attribute = mesh.attributes.end() - 1;
    }
    // Behind an array there may be metadata in brackets.
    const std::size_t array = value.rfind(']');
    const std::size_t size = array == std::string_view::npos ? value.size() : array + 1;
    attribute->places[frame] = {begin + equals + 3, size};
    const std::string_view rest = value.substr(size);
    if (size <= 2 || rest.size() < 4) return;  // an empty array, or none
    const std::string metadata(rest.substr(2, rest.size() - 3));
    const int number = frames_[frame].number;
    if (attribute->metadata.empty()) {
      attribute->metadata = metadata;
      attribute->metadataFrame = number;
    } else if (attribute->metadata != metadata) {
      throw Error(ErrorCode::InvalidArgument,
                  "one .usda cannot hold frame " + std::to_string(attribute->metadataFrame) +
                      ", whose " + std::string(declaration) + " have " + attribute->metadata +
                      ", and frame " + std::to_string(number) + " with " + metadata +
                      "; --crease makes them the same");
    }
  }

  const std::vector<UsdaFrame>& frames_;
  std::vector<std::string> head_;  ///< lines in front of the first mesh, of the first frame
  std::vector<SampledMesh> meshes_;
};

class Writer {
 public:
  Writer(const std::vector<UsdaFrame>& frames, std::ostream& stream)
      : frames_(frames), stream_(stream) {
    for (const UsdaFrame& frame : frames) {
      firstCode_ = std::min(firstCode_, frame.number);
      lastCode_ = std::max(lastCode_, frame.number);
    }
  }

  /// The lines in front of the meshes, with the time codes among the metadata of the file.
  void head(const std::vector<std::string>& lines, std::optional<double> framesPerSecond) {
    for (const std::string& line : lines) {
      if (line == ")") codes(framesPerSecond);
      stream_ << line << '\n';
    }
  }

  void mesh(const SampledMesh& mesh) {
    stream_ << "    " << mesh.head << "\n    {\n";
    for (const SampledAttribute& each : mesh.attributes) attribute(each);
    for (const std::string& line : mesh.uniform) stream_ << kIndent << line << '\n';
    stream_ << "    }\n";
  }

  void finish() { stream_ << "}\n"; }

 private:
  static constexpr const char* kIndent = "        ";

  void codes(std::optional<double> framesPerSecond) {
    stream_ << "    startTimeCode = " << firstCode_ << "\n    endTimeCode = " << lastCode_ << '\n';
    if (!framesPerSecond) return;
    const std::string rate = base::numberText(*framesPerSecond);
    stream_ << "    timeCodesPerSecond = " << rate << "\n    framesPerSecond = " << rate << '\n';
  }

  void attribute(const SampledAttribute& attribute) {
    const std::string& declaration = attribute.declaration;
    const bool isArray = declaration.find("[]") != std::string::npos;
    // The extent of nothing still has two corners.
    const char* const nothing = declaration == "float3[] extent" ? "[(0, 0, 0), (0, 0, 0)]"
                                : isArray                        ? "[]"
                                                                 : "(0, 0, 0)";
    if (!attribute.metadata.empty()) {
      stream_ << kIndent << declaration << " (" << attribute.metadata << ")\n";
    }
    stream_ << kIndent << declaration << ".timeSamples = {\n";
    for (std::size_t frame = 0; frame < frames_.size(); ++frame) {
      stream_ << kIndent << "    " << frames_[frame].number << ": ";
      value(attribute, frame, nothing);
      stream_ << ",\n";
    }
    stream_ << kIndent << "}\n";
  }

  void value(const SampledAttribute& attribute, std::size_t frame, const char* nothing) {
    const Place& place = attribute.places[frame];
    if (place.size == 0) {
      stream_ << nothing;
      return;
    }
    const std::filesystem::path& file = frames_[frame].file;
    std::ifstream from(file, std::ios::binary);
    from.seekg(static_cast<std::streamoff>(place.begin));
    std::array<char, 65536> bytes;
    for (std::uint64_t left = place.size; left > 0;) {
      stopIfAsked();
      const auto size = std::min<std::uint64_t>(left, bytes.size());
      if (!from.read(bytes.data(), static_cast<std::streamsize>(size))) {
        failToRead(file);
      }
      stream_.write(bytes.data(), static_cast<std::streamsize>(size));
      left -= size;
    }
  }

  const std::vector<UsdaFrame>& frames_;
  std::ostream& stream_;
  int firstCode_ = frames_.front().number;
  int lastCode_ = firstCode_;
};

}  // namespace

void joinUsdaFrames(const std::vector<UsdaFrame>& frames, std::optional<double> framesPerSecond,
                    const std::filesystem::path& output) {
  const Frames found(frames);
  const auto writeTo = [&](std::ostream& stream) {
    Writer writer(frames, stream);
    writer.head(found.head(), framesPerSecond);
    for (const SampledMesh& mesh : found.meshes()) writer.mesh(mesh);
    writer.finish();
  };
  writeFile(writeTo, output);
}

}  // namespace tufa::tools
