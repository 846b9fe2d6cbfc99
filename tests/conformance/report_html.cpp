#include <fmt/format.h>

#include "tests/conformance/report.hpp"

namespace trochoid::conformance {

namespace {

constexpr const char* style = R"(<style>
:root{--ink:#16242e;--paper:#f6f9fa;--card:#fff;--line:#d5e0e4;--soft:#5c717c;--passed:#1d7f55;--failed:#b3261e;--skipped:#7a7f45;--sea:#0f5e7a}
@media(prefers-color-scheme:dark){:root{--ink:#dce8ec;--paper:#0d171d;--card:#132129;--line:#263a45;--soft:#8aa0aa;--passed:#5cc797;--failed:#ff8a80;--skipped:#c9cc7e;--sea:#6cc3e0}}
*{box-sizing:border-box}body{margin:0;background:var(--paper);color:var(--ink);font:15px/1.5 system-ui,sans-serif}
main{max-width:1180px;margin:0 auto;padding:28px 20px 60px}h1{font-size:24px;margin:0 0 4px}h2{font-size:17px;margin:34px 0 10px}
.soft{color:var(--soft)}.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(130px,1fr));gap:10px;margin:20px 0}
.card{background:var(--card);border:1px solid var(--line);border-radius:8px;padding:10px 14px}.card b{display:block;font-size:26px;line-height:1.2}
.bar{display:flex;height:10px;border-radius:5px;overflow:hidden;background:var(--line)}.bar i{display:block;height:100%}
table{width:100%;border-collapse:collapse;background:var(--card);border:1px solid var(--line);border-radius:8px}
th,td{text-align:left;padding:5px 10px;border-top:1px solid var(--line);vertical-align:top}th{border-top:0;font-weight:600;color:var(--soft);font-size:13px}
td.n,th.n{text-align:right;font-variant-numeric:tabular-nums}code{font:13px ui-monospace,monospace}
.v{font-weight:600;white-space:nowrap}.passed,.expected{color:var(--passed)}.failed,.unexpected{color:var(--failed)}.skipped{color:var(--skipped)}
i.passed{background:var(--passed)}i.failed{background:var(--failed)}i.skipped{background:var(--skipped)}
.filter{display:flex;flex-wrap:wrap;gap:8px;margin:0 0 10px;align-items:center}.filter button,.filter input{font:inherit;color:inherit;background:var(--card);border:1px solid var(--line);border-radius:16px;padding:3px 12px}
.filter button{cursor:pointer}.filter button[aria-pressed=true]{border-color:var(--sea);box-shadow:inset 0 0 0 1px var(--sea)}
a{color:var(--sea);text-decoration:none}.scroll{overflow-x:auto}
</style>)";

constexpr const char* script = R"(<script>
const rows=[...document.querySelectorAll('#cases tbody tr')],find=document.querySelector('#find');let verdict='';
function show(){const t=find.value.toLowerCase();for(const r of rows)r.hidden=(verdict&&r.dataset.v!==verdict)||(t&&!r.textContent.toLowerCase().includes(t))}
for(const b of document.querySelectorAll('.filter button'))b.onclick=()=>{verdict=b.dataset.v;for(const o of document.querySelectorAll('.filter button'))o.setAttribute('aria-pressed',o===b);show()};
for(const a of document.querySelectorAll('#requirements a'))a.onclick=()=>{find.value=a.textContent+'/';show()};
find.oninput=show;
</script>)";

/// First word of the verdict's name: the class of its colour.
std::string colour(Verdict verdict) {
    const std::string_view name = name_of(verdict);
    return std::string(name.substr(0, name.find(' ')));
}

std::string card(std::string_view number, std::string_view what, std::string_view tint = "") {
    return fmt::format("<div class=\"card\"><b class=\"{}\">{}</b>{}</div>", tint, number, what);
}

std::string bar(const Tally& tally, size_t total) {
    const auto part = [&](const char* tint, int count) {
        return fmt::format("<i class=\"{}\" style=\"width:{:.2f}%\"></i>", tint,
                           100.0 * count / static_cast<double>(total == 0 ? 1 : total));
    };
    return "<div class=\"bar\">" +
           part("passed", tally.of(Verdict::passed) + tally.of(Verdict::expected_failure)) +
           part("failed", tally.of(Verdict::failed) + tally.of(Verdict::unexpected_pass)) +
           part("skipped", tally.of(Verdict::skipped)) + "</div>";
}

std::string requirements(const Report& report) {
    std::string text =
        "<h2>By requirement</h2><div class=\"scroll\"><table id=\"requirements\"><thead><tr><th>requirement</th><th class=\"n\">"
        "cases</th><th class=\"n\">passed</th><th class=\"n\">failed</th><th class=\"n\">skipped</th><th "
        "style=\"width:40%\"></th></tr></thead><tbody>";
    for (const auto& [name, tally] : tally_by_requirement(report.outcomes)) {
        int total = 0;
        for (const auto& [verdict, count] : tally.verdicts) total += count;
        text += fmt::format(
            "<tr><td><a href=\"#cases\">{}</a></td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>"
            "<td class=\"n\">{}</td><td>{}</td></tr>\n",
            escaped(name), total, tally.of(Verdict::passed) + tally.of(Verdict::expected_failure),
            tally.of(Verdict::failed) + tally.of(Verdict::unexpected_pass), tally.of(Verdict::skipped),
            bar(tally, static_cast<size_t>(total)));
    }
    return text + "</tbody></table></div>";
}

std::string filters(const Report& report) {
    const Tally tally = tally_of(report.outcomes);
    std::string text = "<div class=\"filter\"><button data-v=\"\" aria-pressed=\"true\">all</button>";
    for (const auto& [verdict, count] : tally.verdicts)
        text += fmt::format("<button data-v=\"{0}\" aria-pressed=\"false\">{0} {1}</button>",
                            name_of(verdict), count);
    return text + "<input id=\"find\" placeholder=\"find\" aria-label=\"find\"></div>";
}

std::string row(const Outcome& outcome) {
    std::string more;
    if (!outcome.reason.empty())
        more +=
            fmt::format("<br><span class=\"{}\">{}</span>", colour(outcome.verdict), escaped(outcome.reason));
    for (const std::string& note : outcome.notes)
        more += fmt::format("<br><span class=\"soft\">{}</span>", escaped(note));
    const std::string said =
        outcome.close.sentence.empty() ? "" : fmt::format(" title=\"{}\"", escaped(outcome.close.sentence));
    return fmt::format(
        "<tr data-v=\"{}\"><td><code>{}</code></td><td>{}{}</td><td class=\"v {}\">{}</td><td{}>{}</td><td class=\"n\">"
        "{:.1f}</td></tr>\n",
        name_of(outcome.verdict), escaped(outcome.id), escaped(outcome.title), more, colour(outcome.verdict),
        name_of(outcome.verdict), said, escaped(sentence_of(outcome.close)),
        static_cast<double>(outcome.took_us) * 1e-3);
}

}  // namespace

std::string html_of(const Report& report) {
    const Tally tally = tally_of(report.outcomes);
    const bool good = conforms(report);
    std::string text = fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width,initial-scale=1\"><title>{0} {1}</title>{2}</head><body><main>\n<h1>{0} <span "
        "class=\"{3}\">{1}</span></h1>\n<div class=\"soft\">{4} at {5} · {6} · {7} · {8}</div>\n",
        escaped(report.software), good ? "conforms" : "does not conform", style, good ? "passed" : "failed",
        name_of(report.side), escaped(report.target), escaped(report.world), escaped(report.kit),
        escaped(report.started));
    const auto number = [](int count) { return std::to_string(count); };
    text += "<div class=\"cards\">" + card(std::to_string(report.outcomes.size()), "cases") +
            card(number(tally.of(Verdict::passed)), "passed", "passed") +
            card(number(tally.of(Verdict::failed)), "failed", "failed") +
            card(number(tally.of(Verdict::skipped)), "skipped", "skipped") +
            card(number(tally.of(Verdict::expected_failure)), "expected failures") +
            card(number(tally.of(Verdict::unexpected_pass)), "unexpected passes") +
            card(fmt::format("{:.1f} s", static_cast<double>(report.took_us) * 1e-6), "took") + "</div>";
    text += bar(tally, report.outcomes.size());
    for (const std::string& remark : report.remarks)
        text += fmt::format("<p class=\"soft\">{}</p>", escaped(remark));
    text += requirements(report) + "<h2>Cases</h2>" + filters(report);
    text +=
        "<div class=\"scroll\"><table id=\"cases\"><thead><tr><th>case</th><th>what</th><th>verdict</th><th>close</th><th "
        "class=\"n\">ms</th></tr></thead><tbody>\n";
    for (const Outcome& outcome : report.outcomes) text += row(outcome);
    return text + "</tbody></table></div></main>" + script + "</body></html>\n";
}

}  // namespace trochoid::conformance
