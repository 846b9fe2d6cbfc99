#include "protocol/login/key_file.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "protocol/units/operator_error.hpp"

namespace trochoid {
namespace {

namespace fs = std::filesystem;

class KeyFiles : public testing::Test {
protected:
    KeyFiles() {
        fs::remove_all(folder);
        fs::create_directories(folder);
    }
    fs::path file_with(const std::string& text, const char* name = "file") const {
        std::ofstream(folder / name) << text;
        fs::permissions(folder / name, fs::perms::owner_read | fs::perms::owner_write);
        return folder / name;
    }
    template <class Read>
    static std::string complaint(Read read) {
        try {
            read();
        } catch (const OperatorError& error) {
            return error.what();
        }
        return "none";
    }

    const fs::path folder = fs::path(testing::TempDir()) / "trochoid-key-files";
};

TEST_F(KeyFiles, SecretsAreTheirOwnersAloneAndNeverWrittenOver) {
    const fs::path file = folder / "key";
    write_secret_file(file, "first\n");
    EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    EXPECT_NE(complaint([&] { write_secret_file(file, "second\n"); }).find("there already"),
              std::string::npos);
    std::string kept;
    std::getline(std::ifstream(file), kept);
    EXPECT_EQ(kept, "first");
    EXPECT_NE(complaint([&] { write_secret_file(folder / "none" / "key", ""); }).find("folder that exists"),
              std::string::npos);
    fs::create_symlink(folder / "elsewhere", folder / "link");
    EXPECT_NE(complaint([&] { write_secret_file(folder / "link", ""); }), "none") << "links are not followed";
}

TEST_F(KeyFiles, TokensTakeTheOldOnesPlace) {
    const fs::path file = folder / "token";
    for (const char* text : {"first", "second"}) {
        replace_secret_file(file, text);
        EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
        std::string kept;
        std::getline(std::ifstream(file), kept);
        EXPECT_EQ(kept, text);
    }
    EXPECT_EQ(std::distance(fs::directory_iterator(folder), {}), 1) << "nothing is left beside it";
    EXPECT_NE(complaint([&] { replace_secret_file(folder, "text"); }).find("no regular file"),
              std::string::npos);
    write_public_file(folder / "key.pub", "text");
    EXPECT_NE(fs::status(folder / "key.pub").permissions() & fs::perms::group_read, fs::perms::none);
}

TEST_F(KeyFiles, SigningKeys) {
    const SigningKey key = SigningKey::generate();
    write_secret_file(folder / "key", key.pem().text());
    const auto kept = read_signing_key(folder / "key", "--key");
    EXPECT_EQ(kept.key.public_key().raw(), key.public_key().raw());
    EXPECT_EQ(kept.warning, "");
    fs::permissions(folder / "key", fs::perms::group_read, fs::perm_options::add);
    EXPECT_NE(read_signing_key(folder / "key", "--key").warning.find("chmod 600"), std::string::npos);
    const std::string wrong = complaint([&] { read_signing_key(file_with("hello"), "--key"); });
    EXPECT_EQ(wrong.find("--key " + (folder / "file").string()), 0U) << wrong;
    EXPECT_NE(complaint([&] { read_signing_key(folder / "none", "--key"); }).find("cannot be read"),
              std::string::npos);
    EXPECT_NE(complaint([&] { read_signing_key(folder, "--key"); }), "none");
}

TEST_F(KeyFiles, TicketKeys) {
    const std::string digits(64, '5');
    EXPECT_EQ(read_ticket_key(file_with(" " + digits + "\r\nmore\n"), "--ticket-key").warning, "");
    for (const std::string& bad : {std::string(), std::string("5"), digits + "5", std::string(20'000, '5')})
        EXPECT_NE(complaint([&] { read_ticket_key(file_with(bad), "--ticket-key"); }), "none") << bad.size();
}

TEST_F(KeyFiles, TokenKeysMayRepeatButNotTheSame) {
    const TokenKey one = SigningKey::generate().public_key();
    const TokenKey two = SigningKey::generate().public_key();
    const fs::path first = file_with(one.pem(), "one");
    const fs::path second = file_with(two.pem(), "two");
    EXPECT_FALSE(read_token_keys({first, second}, "--token-key").empty());
    EXPECT_TRUE(read_token_keys({}, "--token-key").empty());
    EXPECT_NE(complaint([&] {
                  read_token_keys({first, first}, "--token-key");
              }).find("there already"),
              std::string::npos);
    EXPECT_NE(complaint([&] { read_token_keys(std::vector(17, first), "--token-key"); }).find("at most 16"),
              std::string::npos);
    const fs::path secret = file_with(std::string(SigningKey::generate().pem().text()), "secret");
    EXPECT_NE(complaint([&] { read_token_keys({secret}, "--token-key"); }).find("no public Ed25519 key"),
              std::string::npos);
}

TEST_F(KeyFiles, TokensAreReadFromTheFirstLine) {
    const std::string text =
        sign_token({Role::viewer, {1000}, {1060}, random_nonce(), "scilly"}, SigningKey::generate());
    EXPECT_EQ(read_token(file_with("\t" + text + " \nmore"), "--token-file"), text);
    for (const char* bad : {"", "\n", "a token", "trochoid1.", "trochoid1.AA.AA"})
        EXPECT_NE(complaint([&] { read_token(file_with(bad), "--token-file"); }), "none") << bad;
}

}  // namespace
}  // namespace trochoid
