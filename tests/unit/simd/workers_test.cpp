#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "protocol/model/simd/workers.hpp"

namespace trochoid {
namespace {

TEST(Workers, EveryPartIsDoneOnceWhateverTheNumberOfThreads) {
    for (const unsigned threads : {1U, 2U, 3U, 16U}) {
        Workers workers(threads);
        EXPECT_EQ(workers.threads(), threads);
        for (const size_t parts : {size_t{0}, size_t{1}, size_t{2}, size_t{100}}) {
            std::vector<std::atomic<int>> done(parts);
            std::atomic<bool> in_range{true};
            workers.run(parts, [&](size_t part, unsigned thread) {
                ++done[part];
                if (thread >= threads) in_range = false;
            });
            for (const auto& one : done) EXPECT_EQ(one, 1) << threads << " threads, " << parts << " parts";
            EXPECT_TRUE(in_range);
        }
    }
}

TEST(Workers, NoThreadAsksForThemAll) { EXPECT_GE(Workers(0).threads(), 1U); }

TEST(Workers, AnExceptionComesBackAndTheNextRunIsWhole) {
    Workers workers(4);
    EXPECT_THROW(workers.run(50,
                             [](size_t part, unsigned) {
                                 if (part == 7) throw std::runtime_error("part 7");
                             }),
                 std::runtime_error);
    std::atomic<size_t> sum{0};
    workers.run(50, [&](size_t part, unsigned) { sum += part; });
    EXPECT_EQ(sum, 49U * 50U / 2U);
}

}  // namespace
}  // namespace trochoid
