#include "protocol/login/login_token.hpp"

#include <gtest/gtest.h>

#include "protocol/login/base64url.hpp"
#include "protocol/login/token_keys.hpp"

namespace trochoid {
namespace {

constexpr UnixSeconds noon{1'795'370'400};

UnixSeconds after(UnixSeconds time, int64_t seconds) {
    return {static_cast<uint64_t>(static_cast<int64_t>(time.value) + seconds)};
}

LoginToken director() { return {Role::director, noon, after(noon, 60), random_nonce(), "scilly"}; }

class LoginTokens : public testing::Test {
protected:
    Result<LoginToken> check(const std::string& text, UnixSeconds now = noon, UnixSeconds opened = {}) const {
        return keys.check(text, "scilly", opened, now);
    }
    std::string why(const std::string& text, UnixSeconds now = noon, UnixSeconds opened = {}) const {
        const auto found = check(text, now, opened);
        if (found) return "taken";
        EXPECT_EQ(found.error().code, ErrorCode::token_refused);
        return found.error().message;
    }

    const SigningKey key = SigningKey::generate();
    const SigningKey second = SigningKey::generate();
    const TokenKeys keys{{second.public_key(), key.public_key()}};
};

TEST_F(LoginTokens, AnyOfTheKeysWillDo) {
    for (const SigningKey* signer : {&key, &second}) {
        const LoginToken token = director();
        const auto found = check(sign_token(token, *signer));
        ASSERT_TRUE(found) << found.error().message;
        EXPECT_EQ(*found, token);
    }
}

TEST_F(LoginTokens, TheLongestFits) {
    LoginToken token = director();
    token.world = std::string(longest_audience, 'w');
    const std::string text = sign_token(token, key);
    EXPECT_LE(text.size(), longest_token_text);
    EXPECT_TRUE(keys.check(text, token.world, {}, noon));
}

TEST_F(LoginTokens, TimesHoldToTheSecond) {
    const std::string text = sign_token(director(), key);
    EXPECT_EQ(why(text, after(noon, -31)).find("the token is from the future"), 0U);
    EXPECT_TRUE(check(text, after(noon, -30)));
    EXPECT_TRUE(check(text, after(noon, 90)));
    EXPECT_EQ(why(text, after(noon, 91)).find("the token has expired"), 0U);
    EXPECT_TRUE(check(text, after(noon, 5), noon));
    EXPECT_EQ(why(text, after(noon, 5), after(noon, 1)).find("the token is older than this server's run"),
              0U);
}

TEST_F(LoginTokens, EachRefusalSaysWhatToDo) {
    EXPECT_NE(why("").find("trochoid-ctl token make"), std::string::npos);
    EXPECT_NE(why("a token of the first kind").find("trochoid-ctl token make"), std::string::npos);
    LoginToken elsewhere = director();
    elsewhere.world = "azores";
    EXPECT_NE(why(sign_token(elsewhere, key)).find("--world 'scilly'"), std::string::npos);
    EXPECT_NE(why(sign_token(director(), SigningKey::generate())).find("--token-key"), std::string::npos);
    const auto nobody = TokenKeys().check(sign_token(director(), key), "scilly", {}, noon);
    ASSERT_FALSE(nobody);
    EXPECT_NE(nobody.error().message.find("--token-key"), std::string::npos);
}

// Whatever single character is changed, dropped or doubled, the token is none.
TEST_F(LoginTokens, NoOtherTextWillDo) {
    const std::string good = sign_token(director(), key);
    ASSERT_TRUE(check(good));
    for (size_t i = 0; i < good.size(); ++i) {
        for (const char other : {'A', 'B', '_', '.', '=', ' ', '\n', '\0', '\xc3'}) {
            if (other == good[i]) continue;
            std::string changed = good;
            changed[i] = other;
            ASSERT_FALSE(check(changed)) << i << " " << other;
        }
        std::string shorter = good;
        shorter.erase(i, 1);
        ASSERT_FALSE(check(shorter)) << i;
        std::string longer = good;
        longer.insert(i, 1, good[i]);
        ASSERT_FALSE(check(longer)) << i;
        ASSERT_FALSE(check(good.substr(0, i))) << i;
    }
    EXPECT_FALSE(check(good + std::string(longest_token_text, 'A')));
}

TEST_F(LoginTokens, AKeysIdAloneSignsNothing) {
    // The stranger's token names our key: it is asked, and says no.
    const std::string good = sign_token(director(), key);
    const std::string theirs = sign_token(director(), SigningKey::generate());
    const std::string mixed = good.substr(0, good.rfind('.')) + theirs.substr(theirs.rfind('.'));
    EXPECT_NE(why(mixed).find("not signed by a key that this server knows"), std::string::npos);
}

TEST_F(LoginTokens, OnlySoundValuesAreSigned) {
    EXPECT_TRUE(valid(director()));
    const auto with = [](auto change) {
        LoginToken token = director();
        change(token);
        return valid(token).has_value();
    };
    EXPECT_FALSE(with([](LoginToken& t) { t.role = static_cast<Role>(3); }));
    EXPECT_FALSE(with([](LoginToken& t) { t.expiry = t.issued; }));
    EXPECT_TRUE(with([](LoginToken& t) { t.expiry = after(t.issued, 3600); }));
    EXPECT_FALSE(with([](LoginToken& t) { t.expiry = after(t.issued, 3601); }));
    EXPECT_FALSE(with([](LoginToken& t) { t.world.clear(); }));
    EXPECT_FALSE(with([](LoginToken& t) { t.world = std::string(257, 'w'); }));
    for (const char* bad : {"a\tb", "a\x7f", "a\xc2\x85"})
        EXPECT_FALSE(with([&](LoginToken& t) { t.world = bad; })) << bad;
    EXPECT_TRUE(with([](LoginToken& t) {
        t.world =
            "S\xc3\xbc"
            "d \xc2\xa0";
    }));
}

TEST(TokenKeyTexts, PemComesBackAndNothingElseIsTaken) {
    const SigningKey key = SigningKey::generate();
    const Secret pem = key.pem();
    const auto again = SigningKey::from_pem(pem.text());
    ASSERT_TRUE(again);
    EXPECT_EQ(again->public_key().raw(), key.public_key().raw());
    const auto shown = TokenKey::from_pem(key.public_key().pem());
    ASSERT_TRUE(shown);
    EXPECT_EQ(shown->id(), key.public_key().id());
    EXPECT_FALSE(TokenKey::from_pem(pem.text())) << "a private key is not handed to a server";
    EXPECT_FALSE(SigningKey::from_pem(shown->pem()));
    EXPECT_FALSE(TokenKey::from_pem(""));
    EXPECT_FALSE(TokenKey::from_pem(std::string(100'000, '-')));
    // openssl genpkey -algorithm x25519 | openssl pkey -pubout
    EXPECT_FALSE(
        TokenKey::from_pem("-----BEGIN PUBLIC KEY-----\n"
                           "MCowBQYDK2VuAyEAhSDwCYkwp1R0i33ctD73Wg2/Og0mOBr066SpjqqbTmo=\n"
                           "-----END PUBLIC KEY-----\n"));
}

}  // namespace
}  // namespace trochoid
