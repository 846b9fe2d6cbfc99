#include "server/app/director_token.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

std::filesystem::path file_with(const std::string& text) {
    std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "director-token-test";
    std::ofstream(file) << text;
    return file;
}

TEST(DirectorTokens, FirstLineWithoutBlanksIsTheToken) {
    const DirectorToken token(file_with("  0123456789abcdef\t\r\nsecond line\n"));
    const auto role = token.role_for("0123456789abcdef");
    ASSERT_TRUE(role);
    EXPECT_EQ(*role, Role::admin);
}

TEST(DirectorTokens, EverythingElseIsRefused) {
    const DirectorToken token(file_with("0123456789abcdef"));
    for (const char* wrong : {"0123456789abcdeF", "0123456789abcde", "0123456789abcdef0",
                              "0123456789abcdef0123456789abcdef", "x"}) {
        const auto role = token.role_for(wrong);
        ASSERT_FALSE(role) << wrong;
        EXPECT_EQ(role.error().code, ErrorCode::token_refused);
    }
    const auto viewer = token.role_for("");
    ASSERT_TRUE(viewer);
    EXPECT_EQ(*viewer, Role::viewer);
}

TEST(DirectorTokens, WithoutAFileNoTokenHelpsAndTheMessageSaysHow) {
    const auto role = DirectorToken().role_for("anything");
    ASSERT_FALSE(role);
    EXPECT_NE(role.error().message.find("--director-token-file"), std::string::npos);
}

TEST(DirectorTokens, BadFiles) {
    EXPECT_THROW(DirectorToken{"/does/not/exist"}, OperatorError);
    EXPECT_THROW(DirectorToken{file_with("")}, OperatorError);
    EXPECT_THROW(DirectorToken{file_with("short\n")}, OperatorError);
    EXPECT_THROW(DirectorToken{file_with(std::string(1025, 'x'))}, OperatorError);
}

}  // namespace
}  // namespace trochoid
