#include <gtest/gtest.h>

#include <thread>

#include "client/net/blocking_link.hpp"
#include "protocol/codec/codec.hpp"
#include "protocol/units/operator_error.hpp"
#include "tests/support/net/byte_peer.hpp"
#include "tests/support/net/form_server.hpp"
#include "tests/support/net/raw_server.hpp"
#include "tests/support/net/test_certificate.hpp"
#include "tests/unit/client_net/dialler.hpp"

namespace trochoid {
namespace {

Bytes bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

ServerForm with(const CertificateAndKey& own, bool web = false) {
    ServerForm form;
    form.tls = true;
    form.web = web;
    form.certificate = own.certificate;
    form.key = own.key;
    return form;
}

ServerForm plain_web() {
    ServerForm form;
    form.web = true;
    return form;
}

/// What a client that dials there is told, which has to be that nothing came about and why.
std::string told(const Endpoint& endpoint, const std::function<void()>& meanwhile) {
    Dialler client(endpoint);
    client.send(usual_client_hello());
    meanwhile();
    EXPECT_TRUE(client.ends());
    EXPECT_FALSE(client.connected);
    EXPECT_EQ(client.cause, CloseCause::lost);
    EXPECT_TRUE(client.goodbye.retry);
    return client.goodbye.message;
}

void expect_says(const std::string& message, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        EXPECT_NE(message.find(word), std::string::npos) << "'" << message << "' lacks '" << word << "'";
}

/// The certificates a server may show, seen by a client over TLS and over WebSocket inside it.
struct CertificateTest : testing::TestWithParam<Transport> {
    TestAuthority authority;
    PemFile ca{authority.certificate()};
    const std::string& ca_file = ca.path();
    uint16_t port = 0;

    std::string shown(const ServerForm& form, const std::string& host, const std::string& trusted) {
        FormServer server(form);
        port = server.port();
        return told({host, port, GetParam(), trusted}, [&] { EXPECT_FALSE(server.accept()); });
    }
    std::string address() const { return to_text({"localhost", port, GetParam()}); }
    bool web() const { return is_web(GetParam()); }
};

TEST_P(CertificateTest, from_nobody_we_know) {
    const std::string alone = shown(with(authority.issue(), web()), "localhost", "");
    expect_says(alone, {"the certificate of " + address() + " is not trusted here", "--ca FILE"});
    expect_says(shown(with(self_signed(), web()), "localhost", ""), {"is not trusted", "--ca FILE"});
    const TestAuthority other("another authority");
    const std::string otherwise = shown(with(other.issue(), web()), "localhost", ca_file);
    expect_says(otherwise, {"does not come from " + ca_file, "--ca"});
}

TEST_P(CertificateTest, made_out_to_somebody_else) {
    const CertificateAndKey own = authority.issue({{"sea.example", "*.sea.example", "10.0.0.7"}});
    expect_says(shown(with(own, web()), "localhost", ca_file),
                {"made out to sea.example, *.sea.example, 10.0.0.7, not to localhost", "connect by one"});
    expect_says(shown(with(own, web()), "127.0.0.1", ca_file), {"not to 127.0.0.1"});
    const CertificateAndKey nobody = authority.issue({{}});
    expect_says(shown(with(nobody, web()), "localhost", ca_file), {"names no host", "localhost"});
}

TEST_P(CertificateTest, a_hostile_name_is_not_printed_as_it_is) {
    const CertificateAndKey own = authority.issue({{"a\x1b[31mred", std::string(300, 'x')}});
    const std::string message = shown(with(own, web()), "localhost", ca_file);
    expect_says(message, {"made out to a[31mred, xxx", "..., not to localhost"});
    EXPECT_LT(message.size(), 300U);
}

TEST_P(CertificateTest, out_of_its_time) {
    const CertificateAndKey old = authority.issue({{"localhost"}, -7200, -3600});
    expect_says(shown(with(old, web()), "localhost", ca_file), {"has expired", "new one"});
    const CertificateAndKey coming = authority.issue({{"localhost"}, 3600, 7200});
    expect_says(shown(with(coming, web()), "localhost", ca_file), {"not valid yet", "clock"});
}

TEST_P(CertificateTest, old_tls) {
    ServerForm form = with(authority.issue(), web());
    form.old_tls = true;
    const std::string message = shown(form, "localhost", ca_file);
    expect_says(message, {address(), "has no TLS 1.3"});
}

TEST_P(CertificateTest, tls_for_something_else) {
    ServerForm form = with(authority.issue(), web());
    form.protocol = "imap";
    expect_says(shown(form, "localhost", ca_file), {"speaks TLS, but not Trochoid's protocol", "--connect"});
}

TEST_P(CertificateTest, a_servers_own_certificate_may_be_what_is_trusted) {
    const CertificateAndKey own = authority.issue();
    const PemFile pinned(own.certificate);
    ServerForm form = with(own, web());
    FormServer server(form);
    Dialler client({"localhost", server.port(), GetParam(), pinned.path()});
    client.send(usual_client_hello());
    ASSERT_TRUE(server.log_in(RawServer::usual_hello()));
    EXPECT_TRUE(client.gets(1)) << client.goodbye.message;
}

TEST_P(CertificateTest, no_tls_at_this_port) {
    const std::string plain = to_text(with_encryption({"localhost", 1, GetParam()}, false));
    const std::string advice = "use --connect " + plain.substr(0, plain.rfind(':') + 1);
    for (const std::string& answer : {std::string("HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n"),
                                      std::string("\x18\x01\0\0\0\0\0\0goodbye of a raw server", 30)}) {
        BytePeer peer;
        const std::string message = told({"localhost", peer.port(), GetParam()}, [&] {
            ASSERT_TRUE(peer.accept());
            peer.receive(100);
            peer.send(bytes_of(answer));
        });
        expect_says(message, {"speaks no TLS", advice});
    }
    const std::pair<Bytes, const char*> short_words[] = {
        {{}, "ended the connection in the TLS handshake"},
        {{0x15, 3, 3, 0, 2, 2, 40}, "refuses TLS"},  // the alert handshake_failure
    };
    for (const auto& [answer, words] : short_words) {
        BytePeer peer;
        const Bytes& bytes = answer;
        const std::string message = told({"localhost", peer.port(), GetParam()}, [&] {
            ASSERT_TRUE(peer.accept());
            peer.receive(100);
            peer.send(bytes);
            peer.finish();
        });
        expect_says(message, {words, advice});
    }
}

TEST_P(CertificateTest, files_to_trust_that_are_none) {
    const PemFile noise("no certificate");
    const std::string connect = to_text({"localhost", 7421, GetParam()});
    for (const std::string& file : {noise.path(), testing::TempDir() + "there is no such file.pem"}) {
        try {
            endpoint_from_options(connect, file);
            ADD_FAILURE() << "took " << file;
        } catch (const OperatorError& error) {
            expect_says(error.what(), {"--ca " + file, "PEM"});
        }
        RawServer silent;
        expect_says(told({"localhost", silent.port(), GetParam(), file}, [] {}), {"--ca " + file, "PEM"});
    }
    EXPECT_EQ(endpoint_from_options(connect, ca_file), (Endpoint{"localhost", 7421, GetParam(), ca_file}));
    EXPECT_EQ(endpoint_from_options(connect, ""), (Endpoint{"localhost", 7421, GetParam()}));
}

INSTANTIATE_TEST_SUITE_P(Over, CertificateTest, testing::Values(Transport::tls, Transport::wss),
                         [](const testing::TestParamInfo<Transport>& each) {
                             return each.param == Transport::tls ? "tls" : "wss";
                         });

TEST(Endpoint, trust_is_of_no_use_without_tls) {
    for (const char* plain : {"localhost:7421", "ws://localhost:7421"}) {
        try {
            endpoint_from_options(plain, "any.pem");
            ADD_FAILURE() << "took " << plain;
        } catch (const OperatorError& error) {
            expect_says(error.what(),
                        {"--ca", plain[0] == 'l' ? "tls://localhost:7421" : "wss://localhost:7421"});
        }
    }
}

/// What a client of WebSockets is told that gets this answer to its upgrade.
std::string told_by_http(const std::string& answer) {
    FormServer server(plain_web());
    return told({"localhost", server.port(), Transport::ws},
                [&] { EXPECT_TRUE(server.answer_http(answer)); });
}

std::string http(const char* status, const std::string& body, const char* more = "") {
    return std::string("HTTP/1.1 ") + status + "\r\n" + more +
           "Content-Length: " + std::to_string(body.size()) + "\r\nConnection: close\r\n\r\n" + body;
}

TEST(WebRefusals, each_status_has_its_advice) {
    expect_says(told_by_http(http("403 Forbidden", "Ask by another name\nmore")),
                {"no connections under the name localhost", "(HTTP 403: Ask by another name)"});
    expect_says(told_by_http(http("403 Forbidden", "")),
                {"(HTTP 403): use one of its addresses", "--allow-host"});
    expect_says(told_by_http(http("404 Not Found", "")), {"has no WebSocket (HTTP 404)", "check --connect"});
    expect_says(told_by_http(http("426 Upgrade Required", "encryption required")),
                {"wants encryption (HTTP 426: encryption required)", "use --connect wss://localhost:"});
    expect_says(told_by_http(http("503 Service Unavailable", "draining")),
                {"takes nobody", "draining", "try again"});
    expect_says(told_by_http(http("302 Found", "", "Location: https://elsewhere/\r\n")),
                {"points to https://elsewhere/", "HTTP 302"});
    expect_says(told_by_http(http("200 OK", "<html>")), {"refuses the WebSocket (HTTP 200: <html>)"});
    expect_says(told_by_http(http("500 Internal Server Error", "\x1b[31m" + std::string(5000, 'e'))),
                {"HTTP 500: [31meee", "..."});
}

TEST(WebRefusals, what_is_no_http_at_all) {
    expect_says(told_by_http("TRCS and other noise, long enough to judge\r\n\r\n"),
                {"no server of WebSockets", "--connect"});
    expect_says(told_by_http(""), {"closed the connection instead of making it a WebSocket", "tcp://"});
    expect_says(
        told_by_http("HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: upgrade\r\n"
                     "Sec-WebSocket-Accept: wrong\r\n\r\n"),
        {"no server of WebSockets"});
}

TEST(WebRefusals, another_subprotocol) {
    for (const char* other : {"", "chat"}) {
        ServerForm form = plain_web();
        form.subprotocol = other;
        FormServer server(form);
        const std::string message =
            told({"localhost", server.port(), Transport::ws}, [&] { EXPECT_TRUE(server.accept()); });
        expect_says(message, {"has WebSockets, but not Trochoid's"});
    }
}

TEST(WebRefusals, text_is_answered_with_a_code) {
    FormServer server(plain_web());
    Dialler client({"localhost", server.port(), Transport::ws});
    client.send(usual_client_hello());
    ASSERT_TRUE(server.log_in(RawServer::usual_hello()));
    ASSERT_TRUE(client.gets(1));
    ASSERT_TRUE(server.send_text("hello there"));
    const auto told_back = server.wait_for<Goodbye>();
    ASSERT_TRUE(told_back);
    EXPECT_EQ(told_back->code, ErrorCode::malformed_frame);
    EXPECT_TRUE(server.ends_properly());
    server.hang_up();
    ASSERT_TRUE(client.ends());
    EXPECT_EQ(client.cause, CloseCause::refused_server);
    EXPECT_EQ(client.goodbye.code, ErrorCode::malformed_frame);
}

TEST(PlainRefusals, a_server_of_tls_on_a_plain_connection) {
    FormServer server(with(self_signed()));
    Dialler client({"localhost", server.port()});
    client.send(usual_client_hello());
    EXPECT_FALSE(server.accept());
    server.hang_up();
    ASSERT_TRUE(client.ends());
    expect_says(client.goodbye.message,
                {"without a word before its hello", "where TLS is wanted: tls://localhost:"});
}

TEST(BlockingLink, a_certificate_that_is_not_trusted_counts_as_a_wrong_address) {
    FormServer server(with(self_signed()));
    LinkOptions options;
    options.server = {"localhost", server.port(), Transport::tls};
    std::optional<LinkError> failed;
    std::thread play([&] { server.accept(); });
    try {
        const BlockingLink link(options);
    } catch (const LinkError& error) {
        failed = error;
    }
    play.join();
    ASSERT_TRUE(failed);
    EXPECT_TRUE(failed->unreachable());
    expect_says(failed->what(), {"not trusted"});
}

}  // namespace
}  // namespace trochoid
