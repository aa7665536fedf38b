#include "printing/twin/finding.hpp"

#include <fmt/format.h>

#include <array>

#include "base/core/text.hpp"

namespace pliant::twin {
namespace {

using FindingKind = Finding::Kind;

struct Named {
    FindingKind kind;
    std::string_view name;
    bool acceptable;
};

constexpr std::array<Named, 14> named_findings{{{FindingKind::missing, "missing", false},
                                                {FindingKind::foreign, "foreign", false},
                                                {FindingKind::stray, "stray", false},
                                                {FindingKind::dose, "dose", false},
                                                {FindingKind::light, "light", false},
                                                {FindingKind::height, "height", false},
                                                {FindingKind::image, "image", false},
                                                {FindingKind::volume, "volume", true},
                                                {FindingKind::overcure, "overcure", true},
                                                {FindingKind::contamination, "contamination", true},
                                                {FindingKind::cleaning, "cleaning", true},
                                                {FindingKind::platform, "platform", false},
                                                {FindingKind::fault, "fault", false},
                                                {FindingKind::interlock, "interlock", false}}};

const Named& named(FindingKind kind) {
    for (const Named& entry : named_findings) {
        if (entry.kind == kind) return entry;
    }
    return named_findings.front();
}

}  // namespace

std::string_view finding_name(FindingKind kind) {
    return named(kind).name;
}

bool can_be_accepted(FindingKind kind) {
    return named(kind).acceptable;
}

Result<FindingKind> accepted_finding(std::string_view name) {
    std::vector<std::string> candidates;
    std::string list;
    for (const Named& entry : named_findings) {
        if (!entry.acceptable) continue;
        if (entry.name == name) return entry.kind;
        candidates.emplace_back(entry.name);
        list += (list.empty() ? "" : ", ") + candidates.back();
    }
    for (const Named& entry : named_findings) {
        if (entry.name == name)
            return input_error(
                "the finding \"{}\" cannot be accepted: the print is not the job; what can be accepted: {}", name,
                list);
    }
    const std::string nearest = nearest_name(name, candidates);
    return input_error("there is no finding \"{}\"{}; what can be accepted: {}", name,
                       nearest.empty() ? "" : fmt::format(", did you mean \"{}\"", nearest), list);
}

Result<std::vector<FindingKind>> accepted_findings(std::span<const std::string> names) {
    std::vector<FindingKind> kinds;
    for (const std::string& name : names) {
        const Result<FindingKind> kind = accepted_finding(name);
        if (!kind) return tl::unexpected(kind.error());
        kinds.push_back(*kind);
    }
    return kinds;
}

}  // namespace pliant::twin
