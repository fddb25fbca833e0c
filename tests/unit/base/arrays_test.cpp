#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "base/atomic_bits.h"
#include "base/huge_pages.h"
#include "base/ranked_bits.h"
#include "base/shared_array.h"
#include "base/shrink.h"
#include "base/triangulate.h"

namespace tufa::base {
namespace {

TEST(SharedArray, IsNotCopied) {
  std::vector<int> three{1, 2, 3};
  const int* const data = three.data();
  const SharedArray<int> first(std::move(three));
  SharedArray<int> second = first;
  EXPECT_EQ(first.data(), data);
  EXPECT_EQ(second.data(), data);
  EXPECT_EQ(second[2], 3);
  second = std::vector<int>{4};
  EXPECT_EQ(second.size(), 1U);
  EXPECT_EQ(std::vector<int>(first.begin(), first.end()), (std::vector<int>{1, 2, 3}));
  const std::vector<int> kept{7, 8};
  const SharedArray<int> copy{std::span<const int>(kept)};
  EXPECT_NE(copy.data(), kept.data());
  EXPECT_EQ(copy[1], 8);
  EXPECT_EQ(SharedArray<int>().size(), 0U);
}

TEST(RankedBits, TellHowManyAreBelow) {
  std::mt19937 random(1);
  for (const std::size_t size : {0U, 1U, 63U, 64U, 65U, 1000U}) {
    std::vector<bool> all(size);
    RankedBits bits(size);
    for (std::size_t i = 0; i < size; ++i) {
      if (random() % 3 == 0) all[i] = true, bits.add(i);
    }
    bits.count();
    std::uint32_t below = 0;
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_EQ(bits.has(i), all[i]);
      EXPECT_EQ(bits.rank(i), below);
      below += all[i] ? 1 : 0;
    }
    EXPECT_EQ(bits.size(), below);
    std::vector<std::size_t> members;
    bits.forAll([&](std::size_t i) { members.push_back(i); });
    ASSERT_EQ(members.size(), below);
    for (std::size_t i = 0; i < members.size(); ++i) EXPECT_EQ(bits.rank(members[i]), i);
  }
}

// Each number is told to be new once.
TEST(AtomicBits, AreAddedByManyThreads) {
  constexpr std::size_t kNumbers = 1000, kTimes = 100;
  AtomicBits bits(kNumbers);
  std::atomic<std::size_t> firsts{0};
  Job job(4, {});
  job.run([&] {
    job.forRanges(kNumbers * kTimes, 100, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        if (i % 3 == 0 && !bits.add(i % kNumbers)) ++firsts;
      }
    });
  });
  EXPECT_EQ(firsts, kNumbers);  // 3 divides none of the turns
  EXPECT_TRUE(bits.has(0) && bits.has(kNumbers - 1));
  EXPECT_FALSE(AtomicBits(65).has(64));
}

TEST(Triangulate, IsTheSameByAllThreads) {
  Mesh mesh;
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  for (VertexIndex v = 0; v < 50000; ++v) mesh.quads.emplace_back(v, v + 1, v + 2, v + 3);
  Job job(4, {});
  std::vector<Triangle> triangles;
  job.run([&] { triangles = triangulate(mesh, job); });
  EXPECT_EQ(triangles, tufa::triangulate(mesh));
}

TEST(Shrink, GivesRoomBack) {
  std::vector<int> numbers(1000);
  for (int i = 0; i < 1000; ++i) numbers[static_cast<std::size_t>(i)] = i;
  shrinkTo(numbers, 10);
  EXPECT_EQ(numbers.size(), 10U);
  EXPECT_LT(numbers.capacity(), 1000U);
  EXPECT_EQ(numbers[9], 9);
  release(numbers);
  EXPECT_EQ(numbers.capacity(), 0U);
}

// Many steps of clearing, and an end that fills none.
TEST(LargeArrays, KeepTheirElements) {
  constexpr std::size_t kCount = 3'000'001;
  Job job(2, {});
  std::vector<std::uint64_t> numbers, copy;
  resizeLarge(numbers, kCount, job, std::uint64_t{7});
  ASSERT_EQ(numbers.size(), kCount);
  for (std::size_t i = 0; i < kCount; ++i) ASSERT_EQ(std::exchange(numbers[i], 3 * i), 7U);
  copyLarge(numbers, copy, job);
  EXPECT_EQ(copy, numbers);
  growLarge(copy, 2 * kCount);
  EXPECT_GE(copy.capacity(), 2 * kCount);
  EXPECT_EQ(copy, numbers);
  copy.clear();
  copyLarge(std::vector<std::uint64_t>(), copy, job);
  EXPECT_TRUE(copy.empty());
}

}  // namespace
}  // namespace tufa::base
