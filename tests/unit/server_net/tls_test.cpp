#include "protocol/units/operator_error.hpp"
#include "server/net/tls_identity.hpp"
#include "tests/support/net/raw_client.hpp"
#include "tests/unit/server_net/door_fixture.hpp"

namespace trochoid {
namespace {

using std::chrono::milliseconds;

class TlsFiles : public testing::Test {
protected:
    static std::string mistake(const std::filesystem::path& certificate, const std::filesystem::path& key) {
        try {
            const TlsIdentity identity(certificate, key);
        } catch (const OperatorError& what) {
            return what.what();
        }
        return "";
    }
    static bool has(const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    }
};

TEST_F(TlsFiles, MistakesSayWhatToDo) {
    const CertificateAndKey pair = self_signed();
    const CertificateAndKey other = self_signed();
    const ScratchFile certificate(pair.certificate);
    const ScratchFile key(pair.key);
    const ScratchFile other_key(other.key);
    const ScratchFile nonsense("nonsense\n");
    EXPECT_EQ(mistake(certificate.path, key.path), "");
    EXPECT_TRUE(has(mistake("/nowhere/cert.pem", key.path), "--tls-cert /nowhere/cert.pem: cannot be read"));
    EXPECT_TRUE(
        has(mistake(certificate.path, "/nowhere/key.pem"), "--tls-key /nowhere/key.pem: cannot be read"));
    EXPECT_TRUE(has(mistake(nonsense.path, key.path), "holds no certificate"));
    EXPECT_TRUE(has(mistake(certificate.path, nonsense.path), "holds no private key"));
    EXPECT_TRUE(has(mistake(certificate.path, other_key.path), "does not belong to the certificate"));
    // Behind a passphrase: refused, not asked for at a terminal.
    const ScratchFile locked(
        "-----BEGIN ENCRYPTED PRIVATE KEY-----\nMIGbMFcGCSqGSIb3DQEFDTBKMCkGCSqGSIb3DQEFDDAcBAgAAAAAAAAAAAICCAAw\n"
        "-----END ENCRYPTED PRIVATE KEY-----\n");
    EXPECT_TRUE(has(mistake(certificate.path, locked.path), "without a passphrase"));
}

TEST_F(TlsFiles, WarnsOfCertificatesThatDoNotHold) {
    const auto warning = [](int64_t begins_s, int64_t ends_s) {
        CertificateWish wish;
        wish.begins_s = begins_s;
        wish.ends_s = ends_s;
        const CertificateAndKey pair = self_signed(wish);
        const ScratchFile certificate(pair.certificate);
        const ScratchFile key(pair.key);
        return TlsIdentity(certificate.path, key.path).warning();
    };
    EXPECT_EQ(warning(-3600, 90 * 86400), "");
    EXPECT_TRUE(has(warning(-7200, -3600), "has expired"));
    EXPECT_TRUE(has(warning(3600, 90 * 86400), "holds only from"));
    EXPECT_TRUE(has(warning(-3600, 86400), "renew it"));
}

class Tls : public DoorFixture {};

TEST_F(Tls, OlderVersionsAreRefused) {
    start();
    TlsWish old;
    old.old_tls = true;
    EXPECT_EQ(connect_tls(port(), old), nullptr);
    EXPECT_TRUE(ended_with(ErrorCode::protocol_version));
    EXPECT_EQ(door().handshakes_failed, 1U);
}

TEST_F(Tls, TheCertificateStandsUpToATrustingClient) {
    start();
    TlsWish wish;
    wish.trusted = authority.certificate();
    EXPECT_NE(connect_tls(port(), wish), nullptr);
    wish.host = "sea.example";
    EXPECT_EQ(connect_tls(port(), wish), nullptr);
    wish.host = "localhost";
    wish.trusted = TestAuthority("another").certificate();
    EXPECT_EQ(connect_tls(port(), wish), nullptr);
}

TEST_F(Tls, ProtocolNamesAreOptionalButNotOthers) {
    start();
    TlsWish wish;
    const auto plain = connect_tls(port(), wish);
    ASSERT_TRUE(plain);
    EXPECT_EQ(chosen_protocol(*plain), "");
    wish.protocols = "\x02h2\x08http/1.1";
    const auto web = connect_tls(port(), wish);
    ASSERT_TRUE(web);
    EXPECT_EQ(chosen_protocol(*web), "http/1.1");
    wish.protocols = "\x08http/1.1\x08trochoid";
    const auto raw = connect_tls(port(), wish);
    ASSERT_TRUE(raw);
    EXPECT_EQ(chosen_protocol(*raw), "trochoid");
    wish.protocols = "\x02h2";
    EXPECT_EQ(connect_tls(port(), wish), nullptr);
}

TEST_F(Tls, GarbageInTheHandshakeGetsAnAlert) {
    start();
    const auto pipe = connect_tcp(port());
    pipe->write(
        std::string("\x16\x03\x01\x00\x04"
                    "junkjunk",
                    13));
    const std::string answer = pipe->read_all();
    ASSERT_GE(answer.size(), 7U);
    EXPECT_EQ(answer[0], '\x15');
    EXPECT_TRUE(ended_with(ErrorCode::malformed_frame));
}

TEST_F(Tls, HttpInTheClearStillWorksBesideIt) {
    start();
    EXPECT_EQ(status_of(get("/livez")), 200U);
    const auto tls = connect_tls(port());
    ASSERT_TRUE(tls);
    tls->write(std::string("GET /readyz HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    EXPECT_EQ(body_of(tls->read_all()), "ready\n");
    EXPECT_TRUE(tls->ended_properly());
}

TEST_F(Tls, ARenewedCertificateServesWhoComesNext) {
    start();
    FormClient before(Form::tls, port());
    ASSERT_TRUE(before.log_in());
    const TestAuthority next("next");
    const CertificateAndKey pair = next.issue();
    certificate.write(pair.certificate);
    // The key is still the old one: the pair in use stays.
    EXPECT_TRUE(on_loop([this] {
        try {
            identity->reload();
        } catch (const OperatorError&) {
            return true;
        }
        return false;
    }));
    TlsWish wish;
    wish.trusted = authority.certificate();
    EXPECT_NE(connect_tls(port(), wish), nullptr);
    key.write(pair.key);
    on_loop([this] {
        identity->reload();
        return 0;
    });
    EXPECT_EQ(connect_tls(port(), wish), nullptr);
    wish.trusted = next.certificate();
    EXPECT_NE(connect_tls(port(), wish), nullptr);
    before.send(ClockRequest{1, 0});
    EXPECT_TRUE(before.wait_for<ClockReply>());
}

}  // namespace
}  // namespace trochoid
