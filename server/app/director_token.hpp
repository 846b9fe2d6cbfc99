#pragma once
#include <filesystem>
#include <string>

#include "protocol/codec/messages.hpp"
#include "protocol/units/result.hpp"

namespace trochoid {

/// Who may change the sea: whoever knows the token in the operator's file.
class DirectorToken {
public:
    /// Nobody may.
    DirectorToken() = default;
    /// Reads the first line of the file, without blanks around it: 8 to 1024 characters. Throws OperatorError.
    explicit DirectorToken(const std::filesystem::path& file);

    /// An empty token is a viewer's. A wrong one is token_refused. Takes the same time for every wrong token of a length.
    Result<Role> role_for(const std::string& given) const;
    bool exists() const { return !token_.empty(); }

private:
    std::string token_;
};

}  // namespace trochoid
