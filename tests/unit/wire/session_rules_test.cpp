#include "protocol/wire/session_rules.hpp"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <sstream>

#include "protocol/units/version.hpp"
#include "protocol/wire/requirements.hpp"

namespace trochoid {
namespace {

template <class Message, size_t... I>
std::vector<Message> one_of_each(std::index_sequence<I...>) {
    return {Message(std::in_place_index<I>)...};
}
template <class Message>
std::vector<Message> one_of_each() {
    return one_of_each<Message>(std::make_index_sequence<std::variant_size_v<Message>>());
}

template <class Message, class Hello>
void expect_phases() {
    for (const Message& message : one_of_each<Message>()) {
        const bool hello = std::holds_alternative<Hello>(message);
        const bool goodbye = std::holds_alternative<Goodbye>(message);
        EXPECT_EQ(expected(SessionPhase::awaiting_hello, message).has_value(), hello || goodbye);
        EXPECT_EQ(expected(SessionPhase::open, message).has_value(), !hello);
        EXPECT_EQ(expected(SessionPhase::closed, message).error().code, ErrorCode::unexpected_message);
        EXPECT_EQ(phase_after(SessionPhase::awaiting_hello, message), goodbye ? SessionPhase::closed
                                                                      : hello ? SessionPhase::open
                                                                              : SessionPhase::awaiting_hello);
        EXPECT_EQ(phase_after(SessionPhase::open, message),
                  goodbye ? SessionPhase::closed : SessionPhase::open);
    }
}

TEST(SessionRules, PhasesOfBothSides) {
    expect_phases<ClientMessage, ClientHello>();
    expect_phases<ServerMessage, ServerHello>();
}

TEST(SessionRules, OnlyADirectorChangesTheWorld) {
    for (const ClientMessage& message : one_of_each<ClientMessage>()) {
        EXPECT_TRUE(permitted(Role::admin, message));
        EXPECT_EQ(permitted(Role::viewer, message).has_value(), !std::holds_alternative<Command>(message));
    }
    EXPECT_TRUE(permitted(Role::viewer, Command{1, {}, false, ListBoxes{}}));
    for (const auto& action : {Command{1, {}, false, StopWind{}}, Command{1, {}, false, SetRate{}}})
        EXPECT_EQ(permitted(Role::viewer, action).error().code, ErrorCode::token_required);
    EXPECT_TRUE(permitted(Role::director, Command{1, {}, false, StopWind{}}));
    for (const auto& action : {Command{1, {}, false, SkipTime{}}, Command{1, {}, false, SetRate{}}})
        EXPECT_EQ(permitted(Role::director, action).error().code, ErrorCode::token_required)
            << "time is the admin's";
}

TEST(SessionRules, SequencesAscendWithinEachType) {
    SequenceRule rule;
    EXPECT_FALSE(rule.accept(ViewUpdate{0, {}})) << "0 is no sequence number";
    EXPECT_TRUE(rule.accept(ViewUpdate{1, {}}));
    EXPECT_FALSE(rule.accept(ViewUpdate{1, {}}));
    EXPECT_TRUE(rule.accept(ViewUpdate{7, {}})) << "gaps are allowed";
    EXPECT_EQ(rule.accept(ViewUpdate{6, {}}).error().code, ErrorCode::sequence_not_monotone);
    EXPECT_TRUE(rule.accept(SyncRegions{1, {}})) << "each type counts for itself";
    EXPECT_TRUE(rule.accept(ClockRequest{UINT32_MAX, 0}));
    EXPECT_FALSE(rule.accept(ClockRequest{0, 0})) << "it does not wrap";
    EXPECT_TRUE(rule.accept(Ack{5, 0, 0, {}}));
    EXPECT_TRUE(rule.accept(Ack{5, 0, 900, {}})) << "an ack may be repeated";
    EXPECT_FALSE(rule.accept(Ack{4, 0, 0, {}}));
    EXPECT_TRUE(rule.accept(Goodbye{}));
}

TEST(SessionRules, TheHighestCommonVersionOrACode) {
    ClientHello hello;
    hello.model = model_version;
    const auto with = [&](uint16_t least, uint16_t most) {
        hello.protocol_min = least;
        hello.protocol_max = most;
        return common_version(hello);
    };
    EXPECT_EQ(*with(2, 2), 2);
    EXPECT_EQ(*with(0, 9), protocol_version_max);
    EXPECT_EQ(with(4, 9).error().code, ErrorCode::protocol_version);
    EXPECT_EQ(with(1, 1).error().code, ErrorCode::protocol_version)
        << "its boxes and winds are laid out otherwise";
    EXPECT_EQ(with(0, 0).error().code, ErrorCode::protocol_version);
    hello.model = model_version + 1;
    EXPECT_EQ(with(2, 2).error().code, ErrorCode::model_version);
}

TEST(SessionRules, AGoodbyeNamesTheRequirementAndWhetherToRetry) {
    const Goodbye broken = goodbye_for({ErrorCode::not_finite, "view.qx is not finite"}, 12);
    EXPECT_EQ(broken.code, ErrorCode::not_finite);
    EXPECT_EQ(broken.message, "view.qx is not finite");
    EXPECT_EQ(broken.requirement, requirement::finite_numbers);
    EXPECT_EQ(requirement_of(ErrorCode::too_many_legs), requirement::ranges);
    EXPECT_EQ(requirement_of(ErrorCode::not_moving), 0) << "an answer to a command, no breach";
    EXPECT_EQ(broken.offending_sequence, 12U);
    EXPECT_FALSE(broken.retry);
    const Goodbye busy = goodbye_for({ErrorCode::too_many_sessions, "full"});
    EXPECT_TRUE(busy.retry);
    EXPECT_GT(busy.retry_after_ms, 0U);
    EXPECT_EQ(busy.requirement, 0);
}

std::string text_of(const char* path) {
    std::ostringstream text;
    text << std::ifstream(std::string(TROCHOID_SOURCE_DIR) + path).rdbuf();
    return text.str();
}

TEST(SessionRules, TheStandardSpeaksOfTheseVersions) {
    const std::string standard = text_of("/protocol/README.md");
    const std::string told =
        fmt::format("Protocol version {}, model version {}.", protocol_version_max, model_version);
    EXPECT_NE(standard.find(told), std::string::npos) << told;
}

TEST(SessionRules, TheStandardNamesEveryRequirement) {
    const std::string standard = text_of("/protocol/README.md");
    const std::string constants = text_of("/protocol/wire/requirements.hpp");
    const std::regex number("uint16_t (\\w+) = (\\d+);");
    size_t found = 0;
    for (std::sregex_iterator it(constants.begin(), constants.end(), number), end; it != end; ++it, ++found)
        EXPECT_NE(standard.find("R-" + (*it)[2].str()), std::string::npos) << (*it)[1];
    EXPECT_GT(found, 20U);
}

TEST(SessionRules, EveryProtocolCodeNamesARequirement) {
    for (uint16_t code = 101; code <= 114; ++code)
        EXPECT_NE(requirement_of(static_cast<ErrorCode>(code)), 0) << code;
    EXPECT_EQ(requirement_of(ErrorCode::none), 0);
    EXPECT_EQ(requirement_of(ErrorCode::shutting_down), 0);
}

}  // namespace
}  // namespace trochoid
