#include "base/group.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

namespace tufa::base {
namespace {

// As many as several ranges hold.
TEST(Group, HoldsTheNumbersOfEachKeyInRisingOrderForAnyThreads) {
  constexpr std::uint32_t kCount = 500000, kGroups = 300;
  std::mt19937 random(1);
  std::vector<std::uint32_t> keys(kCount);
  for (std::uint32_t& key : keys) {
    key = static_cast<std::uint32_t>(random() % (kGroups + 1));
    if (key == kGroups) key = kNoGroup;
  }
  std::vector<std::vector<std::uint32_t>> wanted(kGroups);
  for (std::uint32_t i = 0; i < kCount; ++i) {
    if (keys[i] != kNoGroup) wanted[keys[i]].push_back(i);
  }
  for (const int threads : {1, 2}) {
    Job job(threads, {});
    job.run([&] {
      std::vector<std::uint32_t> place(kCount, kNoGroup);
      const Groups groups = groupBy(
          kCount, kGroups, [&](std::uint32_t i) { return keys[i]; },
          [&](std::uint32_t i, std::uint32_t at) { place[i] = at; }, job);
      ASSERT_EQ(groups.first.size(), kGroups + 1);
      for (std::uint32_t g = 0; g < kGroups; ++g) {
        ASSERT_TRUE(std::equal(wanted[g].begin(), wanted[g].end(),
                               groups.members.begin() + groups.first[g],
                               groups.members.begin() + groups.first[g + 1]));
        for (std::uint32_t at = 0; at < wanted[g].size(); ++at) {
          ASSERT_EQ(place[wanted[g][at]], at);
        }
      }
      EXPECT_EQ(std::count(place.begin(), place.end(), kNoGroup),
                std::count(keys.begin(), keys.end(), kNoGroup));
    });
  }
}

TEST(Group, OfNothingIsEmpty) {
  Job job(1, {});
  const auto none = [](std::uint32_t) { return kNoGroup; };
  const auto ignore = [](std::uint32_t, std::uint32_t) {};
  EXPECT_EQ(groupBy(0, 3, none, ignore, job).first, std::vector<std::uint32_t>(4, 0));
  EXPECT_EQ(groupBy(5, 0, none, ignore, job).first, std::vector<std::uint32_t>(1, 0));
  EXPECT_TRUE(groupBy(5, 2, none, ignore, job).members.empty());
}

}  // namespace
}  // namespace tufa::base
