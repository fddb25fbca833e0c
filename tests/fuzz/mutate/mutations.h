#pragma once

#include <cstdint>
#include <random>
#include <string>

namespace tufa::fuzz {

/// Ways to damage a file, as transfer, editors and attackers do: bits, bytes, stretches, numbers in
/// binary and in text. Every choice follows from the random numbers.
class Mutations {
 public:
  explicit Mutations(std::uint64_t seed) : random_(seed) {}

  /// Some mutations of `bytes`, with material from `other`, a file of the same kind.
  [[nodiscard]] std::string mutated(std::string bytes, const std::string& other);

  /// A number below `end`.
  std::size_t below(std::size_t end) { return static_cast<std::size_t>(random_() % end); }

 private:
  void mutate(std::string& bytes, const std::string& other);
  /// A place, often near the front, where the sizes and counts are.
  std::size_t placeIn(const std::string& bytes);
  void flipBit(std::string& bytes);
  void setByte(std::string& bytes);
  void setNumber(std::string& bytes);
  void changeNumberInText(std::string& bytes);
  void cut(std::string& bytes);
  void erase(std::string& bytes);
  void repeat(std::string& bytes);
  void splice(std::string& bytes, const std::string& other);
  void insertText(std::string& bytes);

  std::mt19937_64 random_;
};

}  // namespace tufa::fuzz
