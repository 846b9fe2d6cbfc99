#pragma once
#include <iosfwd>
#include <string>
#include <vector>

#include "tests/conformance/verdict.hpp"

namespace trochoid::conformance {

/// A case of golden vectors: the lines of one kind of one set, or a message.
struct VectorCase {
    std::string id;  ///< "R-203/sincos"
    std::string title;
    std::string set;
    std::string kind;     ///< of messages: the question
    std::string subject;  ///< what its lines begin with
};
/// Those of these groups (none: all), by requirement.
std::vector<VectorCase> vector_cases(const std::vector<std::string>& groups);

/// A stranger's answers to the golden vectors: lines as `vectors` prints them, each behind the `vectors NAME` of its set; records
/// and comments may be there and are passed by. An outcome for each case: failed where a line differs by a bit or is missing.
/// `name`: of what is read, for messages. OperatorError where a line is no question of ours.
std::vector<Outcome> judge_answers(std::istream& answers, const std::string& name,
                                   const std::vector<VectorCase>& cases);

}  // namespace trochoid::conformance
