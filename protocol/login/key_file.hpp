#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "protocol/login/resume_ticket.hpp"
#include "protocol/login/signing_key.hpp"
#include "protocol/login/token_keys.hpp"

// Keys in files. What is wrong with a file is the operator's mistake: OperatorError, which names the option that named it.
namespace trochoid {

/// A secret and what is doubtful about its file: "" or a sentence for the log, as where others may read it.
template <class Key>
struct KeptSecret {
    Key key;
    std::string warning;
};

KeptSecret<SigningKey> read_signing_key(const std::filesystem::path& file, std::string_view option);
/// The first line: 64 hexadecimal digits.
KeptSecret<TicketKey> read_ticket_key(const std::filesystem::path& file, std::string_view option);

/// 1 to most_token_keys files, each another key.
TokenKeys read_token_keys(const std::vector<std::filesystem::path>& files, std::string_view option);
TokenKey read_token_key(const std::filesystem::path& file, std::string_view option);

/// The first line without blanks around it, where that looks like a token.
std::string read_token(const std::filesystem::path& file, std::string_view option);

/// Writes a file that was not there: for its owner alone, or for all to read.
void write_secret_file(const std::filesystem::path& file, std::string_view text);
void write_public_file(const std::filesystem::path& file, std::string_view text);
/// The same for a secret that may take an older one's place; whoever reads sees one or the other whole.
void replace_secret_file(const std::filesystem::path& file, std::string_view text);

}  // namespace trochoid
