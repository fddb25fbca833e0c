#pragma once

#include <tufa/mesh.h>

#include <cstddef>
#include <iterator>
#include <memory>
#include <utility>
#include <vector>

namespace tufa::base {

/// Triangles that are held elsewhere: each by itself, or as the halves of quads, the triangles
/// (0, 1, 2) and (0, 2, 3) of each, one behind the other.
class TriangleView {
 public:
  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Triangle;
    using difference_type = std::ptrdiff_t;
    using pointer = const Triangle*;
    using reference = Triangle;
    Iterator(const TriangleView& view, std::size_t i) : view_(&view), i_(i) {}
    Triangle operator*() const { return (*view_)[i_]; }
    Iterator& operator++() {
      ++i_;
      return *this;
    }
    friend bool operator==(const Iterator& a, const Iterator& b) { return a.i_ == b.i_; }

   private:
    const TriangleView* view_;
    std::size_t i_;
  };

  TriangleView() = default;
  TriangleView(const std::vector<Triangle>& triangles)  // NOLINT(google-explicit-constructor)
      : triangles_(triangles.data()), size_(triangles.size()) {}
  TriangleView(const std::vector<Quad>& quads)  // NOLINT(google-explicit-constructor)
      : quads_(quads.data()), areHalves_(true), size_(2 * quads.size()) {}

  [[nodiscard]] Triangle operator[](std::size_t i) const {
    if (!areHalves_) return triangles_[i];
    const auto& v = quads_[i / 2].vertices;
    const std::size_t half = i % 2;
    return {v[0], v[1 + half], v[2 + half]};
  }
  /// Vertex 0, 1 or 2 of a triangle.
  [[nodiscard]] VertexIndex vertex(std::size_t triangle, std::size_t i) const {
    if (!areHalves_) return triangles_[triangle].vertices[i];
    return quads_[triangle / 2].vertices[i == 0 ? 0 : i + triangle % 2];
  }
  /// The vertex at a corner: corners are numbered 3 * triangle + i.
  [[nodiscard]] VertexIndex corner(std::size_t c) const { return vertex(c / 3, c % 3); }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// Whether they are halves of quads.
  [[nodiscard]] bool areHalves() const { return areHalves_; }
  [[nodiscard]] Iterator begin() const { return {*this, 0}; }
  [[nodiscard]] Iterator end() const { return {*this, size_}; }
  /// Asks for the memory of a triangle.
  void prefetch(std::size_t i) const {
    if (areHalves_) {
      __builtin_prefetch(quads_ + i / 2);
    } else {
      __builtin_prefetch(triangles_ + i);
    }
  }

 private:
  const Triangle* triangles_ = nullptr;
  const Quad* quads_ = nullptr;
  bool areHalves_ = false;
  std::size_t size_ = 0;
};

/// Triangles that do not change once they are made. Copies share them, so that two stages have them
/// at the cost of one; those of quads take two thirds of the memory of others.
class TriangleArray : public TriangleView {
 public:
  TriangleArray() = default;
  /// Of the elements of a vector, without copying them.
  TriangleArray(std::vector<Triangle>&& triangles)  // NOLINT(google-explicit-constructor)
      : TriangleArray(std::make_shared<const std::vector<Triangle>>(std::move(triangles))) {}
  TriangleArray(std::vector<Quad>&& quads)  // NOLINT(google-explicit-constructor)
      : TriangleArray(std::make_shared<const std::vector<Quad>>(std::move(quads))) {}
  /// Whether both are copies of one.
  [[nodiscard]] bool shares(const TriangleArray& other) const {
    return elements_ == other.elements_;
  }

 private:
  template <class T>
  explicit TriangleArray(std::shared_ptr<const std::vector<T>> elements)
      : TriangleView(*elements), elements_(std::move(elements)) {}

  std::shared_ptr<const void> elements_;
};

}  // namespace tufa::base
