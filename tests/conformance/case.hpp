#pragma once
#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tests/conformance/verdict.hpp"

namespace trochoid::conformance {

using Milliseconds = std::chrono::milliseconds;

/// What is under test: a program that serves or asks, or one's answers to the golden vectors.
enum class Side : uint8_t { server, client, vectors };
constexpr std::string_view name_of(Side side) {
    return side == Side::server ? "server" : side == Side::client ? "client" : "vectors";
}

/// One run of one case: what its body may touch, and where it leaves what it saw. Each side derives its own.
class Trial {
public:
    Trial() = default;
    Trial(const Trial&) = delete;
    Trial& operator=(const Trial&) = delete;
    virtual ~Trial() = default;

    /// A figure worth a look in the reports.
    void note(std::string figure) { notes_.push_back(std::move(figure)); }
    /// The close verdict of the case: the last one counts.
    void close_seen(CloseReport close) { close_ = std::move(close); }

    const std::vector<std::string>& notes() const { return notes_; }
    const CloseReport& close() const { return close_; }

private:
    std::vector<std::string> notes_;
    CloseReport close_;
};

/// When and beside what a case may run.
enum class Course : uint8_t {
    together,  ///< beside others
    waiting,   ///< beside others; spends its time waiting for a deadline, so it begins first
    alone,     ///< changes what all see (the clock), so it runs after all others, one by one
};

struct Case {
    std::string id;  ///< requirement first: "R-117/view-vx-high"
    std::string title;
    Side side = Side::server;
    Course course = Course::together;
    int connections = 1;               ///< most connections it has open at a time
    std::function<void(Trial&)> body;  ///< throws Failed or Skipped
};

using Catalogue = std::vector<Case>;

/// Every case of both sides, in the order of the requirements. Ids are unique.
Catalogue whole_catalogue();

}  // namespace trochoid::conformance
