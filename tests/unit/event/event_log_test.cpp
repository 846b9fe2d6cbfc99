#include "server/event/event_log.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace trochoid {
namespace {

Bytes bytes_of(const char* text) { return {text, text + std::strlen(text)}; }

Appended appended(const AppendResult& result) {
    const auto* ok = std::get_if<Appended>(&result);
    EXPECT_NE(ok, nullptr) << "not appended, but alternative " << result.index();
    return ok != nullptr ? *ok : Appended{};
}

TEST(EventLog, GivesBackTheBytesInOrderFromAnyPosition) {
    InMemoryEventLog log;
    EXPECT_TRUE(log.read({0}, 10).empty());
    for (uint64_t i = 0; i < 5; ++i) {
        const Bytes bytes(static_cast<size_t>(i), static_cast<uint8_t>(i + 40));
        EXPECT_EQ(appended(log.append({i}, 100 + i, bytes)).position, LogPosition{i});
    }
    const auto all = log.read({0}, 10);
    ASSERT_EQ(all.size(), 5U);
    for (uint64_t i = 0; i < 5; ++i) {
        EXPECT_EQ(all[i].position, LogPosition{i});
        EXPECT_EQ(all[i].event_id, 100 + i);
        EXPECT_EQ(all[i].bytes, Bytes(static_cast<size_t>(i), static_cast<uint8_t>(i + 40)));
    }
    const auto middle = log.read({2}, 2);
    ASSERT_EQ(middle.size(), 2U);
    EXPECT_EQ(middle[0], all[2]);
    EXPECT_EQ(middle[1], all[3]);
    EXPECT_EQ(log.read({4}, 10).size(), 1U);
    EXPECT_TRUE(log.read({5}, 10).empty());
    EXPECT_TRUE(log.read({UINT64_MAX}, 10).empty());
    EXPECT_TRUE(log.read({0}, 0).empty());
}

TEST(EventLog, RefusesAnotherPositionThanTheEnd) {
    InMemoryEventLog log;
    EXPECT_EQ(log.append({1}, 7, bytes_of("a")), AppendResult(Conflict{{0}}));
    appended(log.append({0}, 7, bytes_of("a")));
    EXPECT_EQ(log.append({0}, 8, bytes_of("b")), AppendResult(Conflict{{1}}));
    EXPECT_EQ(log.append({2}, 8, bytes_of("b")), AppendResult(Conflict{{1}}));
    EXPECT_EQ(log.read({0}, 10).size(), 1U);
    EXPECT_EQ(appended(log.append({1}, 8, bytes_of("b"))).position, LogPosition{1});
}

TEST(EventLog, ARepeatedIdAddsNothingAndAnswersTheSame) {
    InMemoryEventLog log;
    const Appended first = appended(log.append({0}, 7, bytes_of("a")));
    appended(log.append({1}, 8, bytes_of("b")));
    EXPECT_EQ(appended(log.append({0}, 7, bytes_of("a"))), first);
    EXPECT_EQ(appended(log.append({2}, 7, bytes_of("a"))), first) << "whatever position is expected";
    EXPECT_EQ(log.read({0}, 10).size(), 2U);
    EXPECT_EQ(log.read({0}, 10)[0].bytes, bytes_of("a"));
}

TEST(EventLog, TheRollingHashNamesTheBytesTheirBordersAndTheirOrder) {
    const auto hash_after = [](std::initializer_list<const char*> texts) {
        InMemoryEventLog log;
        uint64_t hash = empty_log_hash;
        uint64_t expected = empty_log_hash;
        uint64_t i = 0;
        for (const char* text : texts) {
            hash = appended(log.append({i}, i + 1, bytes_of(text))).log_hash;
            expected = chain_hash(expected, bytes_of(text));
            ++i;
        }
        EXPECT_EQ(hash, expected);
        EXPECT_EQ(log.read({i - 1}, 1).at(0).log_hash, hash);
        return hash;
    };
    EXPECT_EQ(hash_after({"ab", "c"}), hash_after({"ab", "c"}));
    EXPECT_NE(hash_after({"ab", "c"}), hash_after({"a", "bc"}));
    EXPECT_NE(hash_after({"ab", "c"}), hash_after({"c", "ab"}));
    EXPECT_NE(hash_after({"ab", ""}), hash_after({"ab"}));
    EXPECT_NE(hash_after({""}), empty_log_hash);
}

// A ship's new course is two events: the log holds both or none.
TEST(EventLog, ABatchIsTakenWholeOrNotAtAll) {
    const std::vector<NewEvent> batch{{11, bytes_of("the old course ends")},
                                      {12, bytes_of("the new one begins")}};
    InMemoryEventLog log;
    appended(log.append({0}, 7, bytes_of("a")));
    EXPECT_EQ(log.append({0}, batch), AppendResult(Conflict{{1}}));
    EXPECT_EQ(log.append({2}, batch), AppendResult(Conflict{{1}}));
    EXPECT_EQ(log.read({0}, 10).size(), 1U);
    const Appended both = appended(log.append({1}, batch));
    EXPECT_EQ(both.position, LogPosition{1});
    const auto all = log.read({0}, 10);
    ASSERT_EQ(all.size(), 3U);
    EXPECT_EQ(both.log_hash, all[2].log_hash);
    EXPECT_EQ(all[2].position, LogPosition{2});
    EXPECT_EQ(all[2].event_id, 12U);
    EXPECT_EQ(all[2].bytes, batch[1].bytes);
    // The bytes alone make the hash, not how they came.
    InMemoryEventLog single;
    for (const StoredEvent& event : all) appended(single.append(event.position, event.event_id, event.bytes));
    auto one_by_one = single.read({0}, 10);
    EXPECT_TRUE(one_by_one[1].closes);
    one_by_one[1].closes = false;
    EXPECT_EQ(one_by_one, all);
    // Sent again, as after a broken connection.
    EXPECT_EQ(appended(log.append({1}, batch)), both);
    EXPECT_EQ(log.read({0}, 10).size(), 3U);
}

TEST(EventLog, EventsThatCameTogetherSayWhereTheyEnd) {
    InMemoryEventLog log;
    appended(log.append({0}, 1, bytes_of("alone")));
    const std::vector<NewEvent> three{{2, bytes_of("a")}, {3, bytes_of("b")}, {4, bytes_of("c")}};
    appended(log.append({1}, three));
    const auto all = log.read({0}, 10);
    ASSERT_EQ(all.size(), 4U);
    EXPECT_TRUE(all[0].closes);
    EXPECT_FALSE(all[1].closes);
    EXPECT_FALSE(all[2].closes);
    EXPECT_TRUE(all[3].closes);
    EXPECT_EQ(log.hash_at({0}), empty_log_hash);
    for (uint64_t i = 0; i < 4; ++i) EXPECT_EQ(log.hash_at({i + 1}), all[i].log_hash);
    EXPECT_EQ(log.hash_at({5}), std::nullopt);
    EXPECT_EQ(log.hash_at({UINT64_MAX}), std::nullopt);
}

}  // namespace
}  // namespace trochoid
