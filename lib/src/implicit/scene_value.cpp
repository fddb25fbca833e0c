#include "implicit/scene_value.h"

#include <cmath>

#include "base/number_text.h"

namespace tufa::implicit {
namespace {

constexpr double kMostNumber = 1e12;

}  // namespace

std::string SceneValue::shown() const {
  constexpr std::size_t kLongest = 40;
  if (json_->is_structured()) return json_->is_array() ? "an array" : "an object";
  if (json_->is_number_float()) return base::numberText(json_->get<double>());
  const std::string text = json_->dump(-1, ' ', false, Json::error_handler_t::replace);
  return text.size() <= kLongest ? text : text.substr(0, kLongest) + "...";
}

void SceneValue::fail(const std::string& why) const {
  input_->fail((path_.empty() ? "/" : path_) + ": " + why);
}

void SceneValue::failWith(const std::string& due) const {
  fail("must be " + due + ", not " + shown());
}

double SceneValue::number() const {
  const std::string due =
      "a number from " + base::numberText(-kMostNumber) + " to " + base::numberText(kMostNumber);
  if (!json_->is_number()) failWith(due);
  const auto number = json_->get<double>();
  if (!(std::abs(number) <= kMostNumber)) failWith(due);
  return number;
}

double SceneValue::above0() const {
  const double value = number();
  constexpr double kLeast = 1e-12;
  if (!(value >= kLeast)) failWith("a number above 0, of " + base::numberText(kLeast) + " or more");
  return value;
}

double SceneValue::notBelow0() const {
  const double value = number();
  if (value < 0) failWith("a number of 0 or more");
  return value;
}

std::size_t SceneValue::count() const {
  constexpr double kMostCount = 1e9;
  const double value = number();
  if (!(value >= 1 && value <= kMostCount && value == std::floor(value))) {
    failWith("a whole number from 1 to " + base::numberText(kMostCount));
  }
  return static_cast<std::size_t>(value);
}

std::vector<double> SceneValue::numbers(std::size_t count) const {
  if (!json_->is_array() || json_->size() != count) {
    fail("must be an array of " + std::to_string(count) + " numbers, not " +
         (json_->is_array() ? "of " + std::to_string(json_->size()) : shown()));
  }
  std::vector<double> all;
  for (const SceneValue& value : list()) all.push_back(value.number());
  return all;
}

Vec3 SceneValue::point() const {
  const std::vector<double> all = numbers(3);
  return {all[0], all[1], all[2]};
}

Vec3 SceneValue::direction() const {
  const Vec3 along = point();
  constexpr double kShortest = 1e-12;
  if (!(along.length() >= kShortest)) fail("must be a vector of some length");
  return along;
}

std::string SceneValue::text() const {
  if (!json_->is_string()) failWith("a text");
  return json_->get<std::string>();
}

std::vector<SceneValue> SceneValue::list() const {
  if (!json_->is_array()) failWith("an array");
  std::vector<SceneValue> all;
  all.reserve(json_->size());
  for (std::size_t n = 0; n < json_->size(); ++n) all.push_back(at(n));
  return all;
}

SceneValue SceneValue::at(const std::string& key) const {
  return {json_->at(key), path_ + "/" + key, *input_};
}

SceneValue SceneValue::at(std::size_t index) const {
  return {json_->at(index), path_ + "/" + std::to_string(index), *input_};
}

SceneObject::SceneObject(const SceneValue& value) : value_(value) {
  if (!value.json().is_object()) value.failWith("an object");
}

bool SceneObject::has(const std::string& key) {
  asked_.insert(key);
  return value_.json().contains(key);
}

SceneValue SceneObject::at(const std::string& key) {
  if (!has(key)) {
    std::string others;  // one of them may be the key, misspelled
    for (const auto& item : value_.json().items()) {
      others += (others.empty() ? "\"" : ", \"") + item.key() + "\"";
    }
    value_.fail("has no \"" + key + "\"" + (others.empty() ? "" : ", but " + others));
  }
  return value_.at(key);
}

std::optional<SceneValue> SceneObject::find(const std::string& key) {
  if (!has(key)) return std::nullopt;
  return value_.at(key);
}

double SceneObject::numberOr(const std::string& key, double otherwise) {
  const auto value = find(key);
  return value ? value->number() : otherwise;
}

double SceneObject::notBelow0Or(const std::string& key, double otherwise) {
  const auto value = find(key);
  return value ? value->notBelow0() : otherwise;
}

Vec3 SceneObject::pointOr(const std::string& key, const Vec3& otherwise) {
  const auto value = find(key);
  return value ? value->point() : otherwise;
}

void SceneObject::requireNoOther() const {
  for (const auto& item : value_.json().items()) {
    if (asked_.contains(item.key())) continue;
    std::string known;
    for (const std::string& key : asked_) known += (known.empty() ? "" : ", ") + key;
    value_.at(item.key()).fail("is not known here; there are " + known);
  }
}

}  // namespace tufa::implicit
