#pragma once
#include <optional>
#include <string>
#include <vector>

#include "client/app/viewer_options.hpp"

namespace trochoid {

/// The command line of these words.
inline std::optional<ViewerOptions> parsed(const std::vector<std::string>& words,
                                           const ViewerSettings& kept = {}) {
    std::vector<const char*> all{"trochoid-viewer"};
    for (const std::string& word : words) all.push_back(word.c_str());
    return parse_viewer_options(static_cast<int>(all.size()), all.data(), kept);
}

}  // namespace trochoid
