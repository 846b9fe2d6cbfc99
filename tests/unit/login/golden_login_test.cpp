#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>

#include "protocol/login/resume_ticket.hpp"
#include "protocol/login/token_keys.hpp"

// Tokens and tickets that another program has made (Python's cryptography), with their keys: tests/golden/login.txt.
namespace trochoid {
namespace {

using Words = std::vector<std::string>;

std::vector<uint8_t> from_hex(const std::string& text) {
    std::vector<uint8_t> bytes;
    for (size_t i = 0; i + 1 < text.size(); i += 2)
        bytes.push_back(static_cast<uint8_t>(std::stoul(text.substr(i, 2), nullptr, 16)));
    return bytes;
}

template <class Array>
Array array_of(const std::string& text) {
    const std::vector<uint8_t> bytes = from_hex(text);
    Array array{};
    EXPECT_EQ(bytes.size(), array.size());
    std::copy(bytes.begin(), bytes.end(), array.begin());
    return array;
}

std::string text_of(const std::string& hex) {
    const std::vector<uint8_t> bytes = from_hex(hex);
    return {bytes.begin(), bytes.end()};
}

UnixSeconds seconds(const std::string& text) { return {std::stoull(text)}; }

Role role_of(const std::string& name) {
    return std::map<std::string, Role>{
        {"viewer", Role::viewer}, {"director", Role::director}, {"admin", Role::admin}}
        .at(name);
}

class GoldenLogin : public testing::Test {
protected:
    GoldenLogin() {
        std::ifstream in(TROCHOID_SOURCE_DIR "/tests/golden/login.txt");
        for (std::string line; std::getline(in, line);) {
            if (line.empty() || line[0] == '#') continue;
            std::istringstream words(line);
            Words found;
            for (std::string word; words >> word;) found.push_back(word);
            lines[found[0]].push_back(found);
        }
    }
    SigningKey key() {
        return SigningKey::from_seed(array_of<std::array<uint8_t, 32>>(lines["key"].at(0).at(1)));
    }
    TicketKey ticket_key() { return *TicketKey::from_hex(lines["ticketkey"].at(0).at(1)); }

    std::map<std::string, std::vector<Words>> lines;
};

TEST_F(GoldenLogin, KeysAndTheirIds) {
    const Words line = lines["key"].at(0);
    const TokenKey found = key().public_key();
    EXPECT_EQ(found.raw(), (array_of<std::array<uint8_t, 32>>(line.at(2))));
    EXPECT_EQ(found.id(), array_of<KeyId>(line.at(3)));
}

TEST_F(GoldenLogin, TokensAreSignedToTheByte) {
    ASSERT_EQ(lines["token"].size(), 3U);
    for (const Words& line : lines["token"]) {
        const LoginToken token{role_of(line.at(1)), seconds(line.at(2)), seconds(line.at(3)),
                               array_of<Nonce>(line.at(4)), text_of(line.at(5))};
        EXPECT_EQ(sign_token(token, key()), line.at(6));
        const auto checked = TokenKeys({key().public_key()}).check(line.at(6), token.world, {}, token.issued);
        ASSERT_TRUE(checked) << checked.error().message;
        EXPECT_EQ(*checked, token);
    }
}

TEST_F(GoldenLogin, WhatIsWrongIsRefused) {
    ASSERT_GE(lines["refused"].size(), 20U);
    const TokenKeys keys({key().public_key()});
    for (const Words& line : lines["refused"]) {
        const auto checked = keys.check(line.at(3), text_of(line.at(2)), {}, seconds(line.at(1)));
        ASSERT_FALSE(checked) << line.at(3);
        EXPECT_EQ(checked.error().code, ErrorCode::token_refused);
    }
}

TEST_F(GoldenLogin, TicketsOpen) {
    ASSERT_EQ(lines["ticket"].size(), 3U);
    for (const Words& line : lines["ticket"]) {
        ResumeTicket ticket;
        ticket.role = role_of(line.at(1));
        ticket.session = std::stoull(line.at(2));
        ticket.instance.bytes = array_of<std::array<uint8_t, 16>>(line.at(3));
        ticket.issued = seconds(line.at(4));
        ticket.expiry = seconds(line.at(5));
        ticket.nonce = array_of<Nonce>(line.at(6));
        const auto opened = ticket_key().open(from_hex(line.at(7)), ticket.instance, ticket.issued);
        ASSERT_TRUE(opened) << opened.error().message;
        EXPECT_EQ(*opened, ticket);
    }
}

TEST_F(GoldenLogin, WhatIsNoTicketStaysClosed) {
    ASSERT_GE(lines["closed"].size(), 15U);
    for (const Words& line : lines["closed"]) {
        const WorldInstance instance{array_of<std::array<uint8_t, 16>>(line.at(2))};
        const auto opened = ticket_key().open(from_hex(line.at(3)), instance, seconds(line.at(1)));
        ASSERT_FALSE(opened) << line.at(3);
        EXPECT_EQ(opened.error().code, ErrorCode::token_refused);
    }
}

}  // namespace
}  // namespace trochoid
