#pragma once

#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "base/vec3.h"
#include "io/input_bytes.h"

namespace tufa::implicit {

/// A value of a scene file, and the path that leads to it, as in "/objects/2/radius". What is read
/// of it must be as asked: all functions throw Error(UnreadableFile) that names the path.
class SceneValue {
 public:
  using Json = nlohmann::json;

  SceneValue(const Json& json, std::string path, const io::InputBytes& input)
      : json_(&json), path_(std::move(path)), input_(&input) {}

  [[noreturn]] void fail(const std::string& why) const;
  [[noreturn]] void failWith(const std::string& due) const;

  [[nodiscard]] bool isNumber() const { return json_->is_number(); }
  /// Finite, and not so large that products of a few overflow.
  [[nodiscard]] double number() const;
  [[nodiscard]] double above0() const;
  [[nodiscard]] double notBelow0() const;
  [[nodiscard]] std::size_t count() const;
  [[nodiscard]] Vec3 point() const;
  /// A vector of some length.
  [[nodiscard]] Vec3 direction() const;
  /// So many numbers.
  [[nodiscard]] std::vector<double> numbers(std::size_t count) const;
  [[nodiscard]] std::string text() const;
  [[nodiscard]] std::vector<SceneValue> list() const;
  [[nodiscard]] const Json& json() const { return *json_; }
  [[nodiscard]] const io::InputBytes& input() const { return *input_; }
  [[nodiscard]] SceneValue at(const std::string& key) const;
  [[nodiscard]] SceneValue at(std::size_t index) const;

 private:
  /// As messages show it: short.
  [[nodiscard]] std::string shown() const;

  const Json* json_;
  std::string path_;
  const io::InputBytes* input_;
};

/// An object of a scene file that knows which of its keys were asked for.
class SceneObject {
 public:
  /// Throws Error(UnreadableFile) if it is no object.
  explicit SceneObject(const SceneValue& value);

  [[nodiscard]] bool has(const std::string& key);
  /// Fails if there is no such key.
  [[nodiscard]] SceneValue at(const std::string& key);
  /// The key's value, if it is there.
  [[nodiscard]] std::optional<SceneValue> find(const std::string& key);
  [[nodiscard]] double numberOr(const std::string& key, double otherwise);
  [[nodiscard]] double notBelow0Or(const std::string& key, double otherwise);
  [[nodiscard]] Vec3 pointOr(const std::string& key, const Vec3& otherwise);
  [[nodiscard]] const SceneValue& value() const { return value_; }

  /// Fails if there is a key that nobody has asked for: a typing error, most likely.
  void requireNoOther() const;

 private:
  SceneValue value_;
  std::set<std::string> asked_;
};

}  // namespace tufa::implicit
