#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tufa::base {

/// An array that does not change once it is made. Copies share its elements, so that two stages
/// have them at the cost of one.
template <class T>
class SharedArray {
 public:
  SharedArray() = default;
  /// Of the elements of a vector, without copying them.
  SharedArray(std::vector<T>&& elements)  // NOLINT(google-explicit-constructor)
      : elements_(std::make_shared<const std::vector<T>>(std::move(elements))),
        data_(elements_->data()),
        size_(elements_->size()) {}
  /// Of copies of elements.
  explicit SharedArray(std::span<const T> elements)
      : SharedArray(std::vector<T>(elements.begin(), elements.end())) {}

  [[nodiscard]] const T& operator[](std::size_t i) const { return data_[i]; }
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  [[nodiscard]] const T* data() const { return data_; }
  [[nodiscard]] const T* begin() const { return data_; }
  [[nodiscard]] const T* end() const { return data_ + size_; }

 private:
  std::shared_ptr<const std::vector<T>> elements_;
  const T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace tufa::base
