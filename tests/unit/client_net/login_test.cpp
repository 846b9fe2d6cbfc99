#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "client/ctl/ctl_options.hpp"
#include "client/ctl/ctl_token_subcommands.hpp"
#include "protocol/login/key_file.hpp"
#include "protocol/login/token_keys.hpp"
#include "protocol/units/operator_error.hpp"

// How programs log in: a token from a file, or one of their own for each connection.
namespace trochoid {
namespace {

namespace fs = std::filesystem;

class Logins : public testing::Test {
protected:
    Logins() {
        fs::remove_all(folder);
        fs::create_directories(folder);
        write_secret_file(folder / "key", key.pem().text());
    }
    std::string file(const char* name) const { return (folder / name).string(); }
    static LoginToken inside(const std::string& text) {
        const auto found = parse_token(text);
        EXPECT_TRUE(found) << text;
        return found ? found->token : LoginToken{};
    }

    const fs::path folder = fs::path(testing::TempDir()) / "trochoid-logins";
    const SigningKey key = SigningKey::generate();
};

TEST_F(Logins, AKeySignsATokenForEachConnection) {
    const TokenSource source({"", file("key"), ""});
    EXPECT_TRUE(source.signs());
    const std::string first = source.token(Role::director, "scilly");
    const LoginToken told = inside(first);
    EXPECT_EQ(told.role, Role::director);
    EXPECT_EQ(told.world, "scilly");
    EXPECT_EQ(told.expiry.value - told.issued.value, usual_token_life);
    EXPECT_NE(inside(source.token(Role::director, "scilly")).nonce, told.nonce);
    EXPECT_TRUE(TokenKeys({key.public_key()}).check(first, "scilly", {}, told.issued));
    EXPECT_THROW(source.token(Role::viewer), OperatorError) << "no world";
}

TEST_F(Logins, AWorldThatWasNamedCounts) {
    const TokenSource source({"", file("key"), "azores"});
    EXPECT_EQ(inside(source.token(Role::viewer, "scilly")).world, "azores");
    EXPECT_THROW(TokenSource({"", file("key"), std::string(257, 'w')}), OperatorError);
}

TEST_F(Logins, AFilesTokenIsWhatItIs) {
    const std::string text = TokenSource({"", file("key"), "azores"}).token(Role::admin);
    std::ofstream(folder / "token") << text << "\n";
    const TokenSource source({file("token"), "", ""});
    EXPECT_FALSE(source.signs());
    EXPECT_EQ(source.token(Role::viewer, "scilly"), text);
    EXPECT_EQ(TokenSource().token(Role::admin, "scilly"), "");
}

TEST_F(Logins, WordsThatDoNotGoTogether) {
    EXPECT_THROW(TokenSource({file("key"), file("key"), ""}), OperatorError);
    EXPECT_THROW(TokenSource({"", "", "azores"}), OperatorError);
    EXPECT_THROW(TokenSource({file("key"), "", ""}), OperatorError) << "a key is no token";
    EXPECT_THROW(TokenSource({"", file("none"), ""}), OperatorError);
}

TEST(LoginRoles, EverythingIsAskedForAsTheLeastThatMay) {
    EXPECT_EQ(role_for(CtlList{}), Role::viewer);
    EXPECT_EQ(role_for(CtlTime{}), Role::viewer);
    for (const CommandAction& action :
         {CommandAction{StartWind{}}, CommandAction{StartShip{}}, CommandAction{Steer{}},
          CommandAction{StopWind{}}, CommandAction{ChangeLand{}}})
        EXPECT_EQ(role_for(CtlCommand{action, {}}), Role::director) << action.index();
    EXPECT_EQ(role_for(CtlCommand{SetRate{}, {}}), Role::admin);
    EXPECT_EQ(role_for(CtlCommand{SkipTime{}, {}}), Role::admin);
}

TEST(TokenLives, SecondsMinutesHours) {
    EXPECT_EQ(token_life_of("1"), 1U);
    EXPECT_EQ(token_life_of("90s"), 90U);
    EXPECT_EQ(token_life_of("10m"), 600U);
    EXPECT_EQ(token_life_of("1h"), 3600U);
    for (const char* bad :
         {"", "0", "3601", "61m", "2h", "1d", "1 m", "-1", "1.5m", "m", "18446744073709551617"})
        EXPECT_THROW(token_life_of(bad), OperatorError) << bad;
}

}  // namespace
}  // namespace trochoid
