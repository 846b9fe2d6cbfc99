#pragma once
#include <cstdint>
#include <string_view>

namespace trochoid {

/// What becomes of a client's wish to go on with what it holds.
enum class ResumeVerdict : uint8_t {
    resumed,
    other_instance,    ///< another life of the world
    unknown_position,  ///< this node does not have so much of the log
    other_history,     ///< the log up to that position is another one
    no_such_key,       ///< no server chooses such a key, or it would cost too much
    too_old,           ///< the world as of the key is not kept any more
    other_state,       ///< what the key comes to is not what the client holds
};

constexpr std::string_view name_of(ResumeVerdict verdict) {
    switch (verdict) {
        case ResumeVerdict::resumed: return "resumed";
        case ResumeVerdict::other_instance: return "other_instance";
        case ResumeVerdict::unknown_position: return "unknown_position";
        case ResumeVerdict::other_history: return "other_history";
        case ResumeVerdict::no_such_key: return "no_such_key";
        case ResumeVerdict::too_old: return "too_old";
        case ResumeVerdict::other_state: return "other_state";
    }
    return "";
}

}  // namespace trochoid
