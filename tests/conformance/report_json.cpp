#include <nlohmann/json.hpp>

#include "tests/conformance/report.hpp"

namespace trochoid::conformance {

namespace {

using Json = nlohmann::ordered_json;

Json json_of(const CloseReport& close) {
    Json json{{"verdict", name_of(close.verdict)}};
    if (close.goodbye_us >= 0) {
        json["code"] = static_cast<unsigned>(close.code);
        json["requirement"] = close.requirement;
        json["sentence"] = close.sentence;
        json["goodbye_us"] = close.goodbye_us;
    }
    if (close.end_us >= 0) json["end_us"] = close.end_us;
    return json;
}

Json sums_of(const Tally& tally) {
    Json json = Json::object();
    for (const auto& [verdict, count] : tally.verdicts) json[std::string(name_of(verdict))] = count;
    return json;
}

}  // namespace

std::string json_of(const Report& report) {
    Json json{{"format", "trochoid-conformance 1"},
              {"side", name_of(report.side)},
              {"target", report.target},
              {"software", report.software},
              {"world", report.world},
              {"kit", report.kit},
              {"started", report.started},
              {"took_us", report.took_us},
              {"conforms", conforms(report)},
              {"verdicts", sums_of(tally_of(report.outcomes))},
              {"remarks", report.remarks}};
    json["requirements"] = Json::object();
    for (const auto& [name, tally] : tally_by_requirement(report.outcomes))
        json["requirements"][name] = sums_of(tally);
    json["cases"] = Json::array();
    for (const Outcome& outcome : report.outcomes) {
        Json entry{{"id", outcome.id},
                   {"requirement", requirement_of_case(outcome.id)},
                   {"title", outcome.title},
                   {"verdict", name_of(outcome.verdict)}};
        if (!outcome.reason.empty()) entry["reason"] = outcome.reason;
        entry["close"] = json_of(outcome.close);
        if (!outcome.notes.empty()) entry["notes"] = outcome.notes;
        entry["took_us"] = outcome.took_us;
        json["cases"].push_back(std::move(entry));
    }
    return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace trochoid::conformance
