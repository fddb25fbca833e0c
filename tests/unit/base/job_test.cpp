#include "base/job.h"

#include <gtest/gtest.h>

#include <tufa/error.h>
#include <atomic>
#include <thread>
#include <vector>

namespace tufa::base {
namespace {

TEST(JobStages, OfUnknownLengthMoveOnWithoutReachingTheirEnd) {
  std::vector<double> fractions;
  Job job(1, [&](std::string_view, double fraction) {
    fractions.push_back(fraction);
    return true;
  });
  job.run([&] {
    job.beginStage("known", 0.2);
    job.forRanges(100, 1, [](std::size_t, std::size_t) {});
    job.beginStage("unknown", 0.9, Length::Unknown);
    // However many loops there are: the first of them is not the whole stage.
    for (int loop = 0; loop < 100; ++loop) {
      job.forRanges(100, 1, [](std::size_t, std::size_t) {});
      job.checkCancelled(0, 1);
    }
    EXPECT_GT(fractions.back(), 0.2);
    EXPECT_LT(fractions.back(), 0.9);
    (void)job.finish();
  });
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
}

TEST(JobStages, OfSeveralLoopsMoveOnByTheirShares) {
  std::vector<double> fractions;
  Job job(1, [&](std::string_view, double fraction) {
    fractions.push_back(fraction);
    return true;
  });
  job.run([&] {
    job.beginStage("loops", 0.5);
    for (int loop = 0; loop < 4; ++loop) {
      job.beginLoop(0.25 * loop, 0.25 * (loop + 1));
      EXPECT_DOUBLE_EQ(fractions.back(), 0.125 * loop);
      job.forRanges(100, 1, [](std::size_t, std::size_t) {});
    }
    EXPECT_DOUBLE_EQ(fractions.back(), 0.5);
    job.beginStage("one loop", 1);
    job.forRanges(100, 50, [](std::size_t, std::size_t) {});
    EXPECT_DOUBLE_EQ(fractions.back(), 1);
    (void)job.finish();
  });
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
}

TEST(ProgressState, TellsStageFractionAndTheRest) {
  std::vector<bool> estimated;
  const Progress progress = [&](const ProgressState& state) {
    EXPECT_EQ(state.stage, "work");
    EXPECT_GE(state.secondsLeft.value_or(0), 0);
    estimated.push_back(state.secondsLeft.has_value());
    return state.fraction < 1;
  };
  EXPECT_TRUE(progress("work", 0));
  EXPECT_TRUE(progress("work", 0.5));
  EXPECT_FALSE(progress("work", 1));
  EXPECT_TRUE(progress("work", 0.01));  // of the next call
  EXPECT_EQ(estimated, (std::vector{false, true, true, false}));
  EXPECT_FALSE(Progress());
  EXPECT_FALSE(Progress(nullptr));
}

TEST(JobParts, AreDoneOnceEachAndTellTheCallerHowFarAllAre) {
  constexpr std::size_t kParts = 12, kCount = 5000;
  const std::thread::id caller = std::this_thread::get_id();
  std::vector<double> fractions;
  bool foreign = false;
  Job job(3, [&](std::string_view, double fraction) {
    foreign |= std::this_thread::get_id() != caller;
    fractions.push_back(fraction);
    return true;
  });
  std::vector<std::vector<int>> visits(kParts, std::vector<int>(kCount));
  job.run([&] {
    job.beginStage("all", 0.5);
    job.forParts(kParts, [&](Job& part, std::size_t index) {
      part.beginStage("first", 0.25);
      part.beginStage("second", 1);
      part.forRanges(kCount, 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) ++visits[index][i];
      });
    });
    (void)job.finish();
  });
  for (const std::vector<int>& part : visits) EXPECT_EQ(part, std::vector<int>(kCount, 1));
  EXPECT_FALSE(foreign);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GT(fractions.size(), 3u);
  EXPECT_LE(fractions[fractions.size() - 2], 0.5);
}

TEST(JobParts, ThrowWhatOneOfThemThrows) {
  for (const int threads : {1, 4}) {
    Job job(threads, {});
    std::atomic<int> begun{0};
    const auto run = [&] {
      job.run([&] {
        job.forParts(1000, [&](Job& part, std::size_t index) {
          ++begun;
          if (index == 0) throw Error(ErrorCode::UnsupportedGrid, "this part");
          part.forRanges(100, 1, [](std::size_t, std::size_t) {});
        });
      });
    };
    try {
      run();
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::UnsupportedGrid);
    }
    EXPECT_LT(begun, 1000) << "the others were not stopped";
  }
}

TEST(JobParts, StopWhenTheCallerSaysSo) {
  for (const int threads : {1, 4}) {
    int calls = 0;
    std::atomic<int> ended{0};
    Job job(threads, [&](std::string_view, double) { return ++calls < 5; });
    try {
      job.run([&] {
        job.forParts(1000, [&](Job& part, std::size_t) {
          part.beginStage("stage", 1);
          for (int i = 0; i < 10; ++i) part.checkCancelled(0, 1);
          ++ended;
        });
      });
      ADD_FAILURE() << "nothing was thrown";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::Cancelled);
    }
    EXPECT_LT(ended, 1000);
  }
}

}  // namespace
}  // namespace tufa::base
