#include "protocol/login/resume_ticket.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace trochoid {
namespace {

constexpr UnixSeconds noon{1'795'370'400};

ResumeTicket some_ticket() {
    ResumeTicket ticket;
    ticket.role = Role::director;
    ticket.session = 77;
    ticket.instance.bytes[3] = 9;
    ticket.issued = noon;
    ticket.expiry = {noon.value + ticket_life};
    ticket.nonce = random_nonce();
    return ticket;
}

TEST(ResumeTickets, AnyNodeWithTheKeyOpensIt) {
    const std::string digits(64, 'c');
    const ResumeTicket ticket = some_ticket();
    const auto opened =
        TicketKey::from_hex(digits)->open(TicketKey::from_hex(digits)->seal(ticket), ticket.instance, noon);
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_EQ(*opened, ticket);
    EXPECT_FALSE(TicketKey::random().open(TicketKey::from_hex(digits)->seal(ticket), ticket.instance, noon));
}

TEST(ResumeTickets, NoTwoLookAlikeAndNoneShowsWhatIsInside) {
    const TicketKey key = TicketKey::random();
    const ResumeTicket ticket = some_ticket();
    const auto sealed = key.seal(ticket);
    const auto twin = key.seal(ticket);
    EXPECT_LE(sealed.size(), longest_ticket);
    EXPECT_NE(sealed, twin);
    EXPECT_EQ(std::search(sealed.begin(), sealed.end(), ticket.nonce.begin(), ticket.nonce.end()),
              sealed.end());
}

TEST(ResumeTickets, EveryBitCounts) {
    const TicketKey key = TicketKey::random();
    const ResumeTicket ticket = some_ticket();
    const auto sealed = key.seal(ticket);
    for (size_t bit = 0; bit < sealed.size() * 8; ++bit) {
        auto changed = sealed;
        changed[bit / 8] = static_cast<uint8_t>(changed[bit / 8] ^ (1U << (bit % 8)));
        ASSERT_FALSE(key.open(changed, ticket.instance, noon)) << bit;
    }
    for (size_t length = 0; length < sealed.size(); ++length)
        ASSERT_FALSE(key.open(std::span(sealed).first(length), ticket.instance, noon)) << length;
    auto longer = sealed;
    longer.push_back(0);
    EXPECT_FALSE(key.open(longer, ticket.instance, noon));
}

TEST(ResumeTickets, TimesAndTheWorldsLife) {
    const TicketKey key = TicketKey::random();
    const ResumeTicket ticket = some_ticket();
    const auto sealed = key.seal(ticket);
    EXPECT_TRUE(key.open(sealed, ticket.instance, ticket.expiry));
    EXPECT_FALSE(key.open(sealed, ticket.instance, {ticket.expiry.value + 1}));
    EXPECT_TRUE(key.open(sealed, ticket.instance, {noon.value - 30}));
    EXPECT_FALSE(key.open(sealed, ticket.instance, {noon.value - 31}));
    const auto other = key.open(sealed, WorldInstance{}, noon);
    ASSERT_FALSE(other);
    EXPECT_EQ(other.error().code, ErrorCode::token_refused);
    EXPECT_NE(other.error().message.find("another life of the world"), std::string::npos);
}

TEST(ResumeTickets, KeysAreSixtyFourDigits) {
    EXPECT_TRUE(TicketKey::from_hex("0123456789abcdefABCDEF0123456789" + std::string(32, '0')));
    for (const std::string& bad : {std::string(), std::string(63, '0'), std::string(65, '0'),
                                   std::string(63, '0') + "g", std::string(62, '0') + " 0"})
        EXPECT_FALSE(TicketKey::from_hex(bad)) << bad;
}

}  // namespace
}  // namespace trochoid
