#pragma once

#include <tufa/mesh.h>
#include <algorithm>
#include <bit>
#include <cstdint>
#include <vector>

namespace tufa::refine {

/// Edges by rising cost, compared by its power of two only; among equals first come, first served.
/// Constant time instead of logarithmic, and kind to the cache: edges pushed one after another,
/// which are near each other, mostly come back so.
class EdgeQueue {
 public:
  struct Entry {
    VertexIndex a, b;
    std::uint32_t versionA, versionB;
  };

  EdgeQueue() : buckets_(kBuckets) {}

  void push(double cost, const Entry& entry) {
    const std::size_t bucket =
        std::bit_cast<std::uint32_t>(static_cast<float>(std::max(cost, 0.0))) >> kShift;
    buckets_[bucket].entries.push_back(entry);
    least_ = std::min(least_, bucket);
  }
  /// False once there is none.
  bool pop(Entry& entry) {
    for (; least_ < kBuckets; ++least_) {
      Bucket& bucket = buckets_[least_];
      if (bucket.next < bucket.entries.size()) {
        entry = bucket.entries[bucket.next++];
        return true;
      }
      bucket.entries.clear();
      bucket.next = 0;
    }
    return false;
  }

 private:
  struct Bucket {
    std::vector<Entry> entries;
    std::size_t next = 0;
  };
  static constexpr int kShift = 23;  // leaves the exponent
  static constexpr std::size_t kBuckets = std::size_t{1} << (31 - kShift);
  std::vector<Bucket> buckets_;
  std::size_t least_ = kBuckets;
};

}  // namespace tufa::refine
