#include "protocol/login/key_file.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <utility>

#include "protocol/units/operator_error.hpp"

namespace trochoid {

namespace {

constexpr size_t longest_file = 16384;

std::string named(const std::filesystem::path& file, std::string_view option) {
    return fmt::format("{} {}", option, file.string());
}

Secret contents(const std::filesystem::path& file, std::string_view option) {
    std::ifstream in(file, std::ios::binary);
    Secret whole(longest_file + 1);
    in.read(reinterpret_cast<char*>(whole.bytes().data()), static_cast<std::streamsize>(longest_file + 1));
    if (in.bad() || in.gcount() <= 0)
        throw OperatorError(
            fmt::format("{}: cannot be read, or is empty; name a file that is there", named(file, option)));
    const auto size = static_cast<size_t>(in.gcount());
    if (size > longest_file)
        throw OperatorError(fmt::format("{}: holds more than {} bytes, which no key does",
                                        named(file, option), longest_file));
    return Secret(whole.bytes().first(size));
}

std::string_view first_line(std::string_view text) {
    text = text.substr(0, text.find('\n'));
    constexpr const char* blanks = " \t\r";
    text.remove_prefix(std::min(text.size(), text.find_first_not_of(blanks)));
    return text.substr(0, text.find_last_not_of(blanks) + 1);
}

// "" where nobody but the owner may do anything with the file.
std::string doubt_about(const std::filesystem::path& file, std::string_view option) {
    using std::filesystem::perms;
    std::error_code unknown;
    const perms found = std::filesystem::status(file, unknown).permissions();
    if (unknown || (found & (perms::group_all | perms::others_all)) == perms::none) return {};
    return fmt::format("{}: others than its owner may open this secret; say chmod 600 {}",
                       named(file, option), file.string());
}

void write_all(int file, std::string_view text, const std::filesystem::path& name) {
    while (!text.empty()) {
        const ssize_t written = ::write(file, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            ::close(file);
            std::error_code ignored;
            std::filesystem::remove(name, ignored);
            throw OperatorError(fmt::format("{}: cannot be written; is the disk full?", name.string()));
        }
        text.remove_prefix(static_cast<size_t>(written));
    }
}

void write_new_file(const std::filesystem::path& file, std::string_view text, mode_t mode) {
    // One step: whoever comes first has it, and nobody else may open it in between.
    const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor < 0 && errno == EEXIST)
        throw OperatorError(
            fmt::format("{} is there already and is not written over: name another file", file.string()));
    if (descriptor < 0)
        throw OperatorError(
            fmt::format("{}: cannot be written; name a file in a folder that exists", file.string()));
    write_all(descriptor, text, file);
    if (::close(descriptor) != 0)
        throw OperatorError(fmt::format("{}: cannot be written; is the disk full?", file.string()));
}

}  // namespace

KeptSecret<SigningKey> read_signing_key(const std::filesystem::path& file, std::string_view option) {
    const Secret text = contents(file, option);
    std::optional<SigningKey> key = SigningKey::from_pem(text.text());
    if (!key)
        throw OperatorError(fmt::format(
            "{}: holds no private Ed25519 key (PEM, no password); make one with trochoid-ctl token new-key FILE",
            named(file, option)));
    return {*std::move(key), doubt_about(file, option)};
}

KeptSecret<TicketKey> read_ticket_key(const std::filesystem::path& file, std::string_view option) {
    const Secret text = contents(file, option);
    std::optional<TicketKey> key = TicketKey::from_hex(first_line(text.text()));
    if (!key)
        throw OperatorError(fmt::format(
            "{}: the first line is not 64 hexadecimal digits; make one with: openssl rand -hex 32",
            named(file, option)));
    return {*std::move(key), doubt_about(file, option)};
}

TokenKey read_token_key(const std::filesystem::path& file, std::string_view option) {
    const Secret text = contents(file, option);
    std::optional<TokenKey> key = TokenKey::from_pem(text.text());
    if (!key)
        throw OperatorError(fmt::format(
            "{}: holds no public Ed25519 key (PEM); trochoid-ctl token new-key FILE writes one to FILE.pub",
            named(file, option)));
    return *std::move(key);
}

TokenKeys read_token_keys(const std::vector<std::filesystem::path>& files, std::string_view option) {
    if (files.size() > most_token_keys)
        throw OperatorError(
            fmt::format("{}: {} keys, but at most {} are taken", option, files.size(), most_token_keys));
    std::vector<TokenKey> keys;
    for (const std::filesystem::path& file : files) {
        TokenKey key = read_token_key(file, option);
        const bool twice =
            std::any_of(keys.begin(), keys.end(), [&](const TokenKey& k) { return k.id() == key.id(); });
        if (twice) throw OperatorError(fmt::format("{}: this key is there already", named(file, option)));
        keys.push_back(std::move(key));
    }
    return TokenKeys(std::move(keys));
}

std::string read_token(const std::filesystem::path& file, std::string_view option) {
    const Secret text = contents(file, option);
    const std::string_view token = first_line(text.text());
    if (!parse_token(token))
        throw OperatorError(fmt::format(
            "{}: holds no token in its first line; make one with trochoid-ctl token make --out FILE",
            named(file, option)));
    return std::string(token);
}

void write_secret_file(const std::filesystem::path& file, std::string_view text) {
    write_new_file(file, text, S_IRUSR | S_IWUSR);
}

void write_public_file(const std::filesystem::path& file, std::string_view text) {
    write_new_file(file, text, S_IRUSR | S_IWUSR | S_IRGRP | S_IROTH);
}

void replace_secret_file(const std::filesystem::path& file, std::string_view text) {
    std::error_code failed;
    if (std::filesystem::exists(file, failed) && !std::filesystem::is_regular_file(file, failed))
        throw OperatorError(fmt::format("{} is no regular file: name a file to write to", file.string()));
    std::filesystem::path partial = file;
    partial += ".partial";
    std::filesystem::remove(partial, failed);
    write_secret_file(partial, text);
    std::filesystem::rename(partial, file, failed);
    if (failed)
        throw OperatorError(fmt::format("{}: cannot be written: {}", file.string(), failed.message()));
}

}  // namespace trochoid
