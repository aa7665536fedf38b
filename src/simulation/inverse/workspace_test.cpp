// Workspaces: samples are equilibria, and an interrupted search gives the same bits.
#include "simulation/inverse/workspace.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "base/core/near.hpp"
#include "simulation/inverse/test_robots.hpp"
#include "simulation/inverse/workspace_record.hpp"

using namespace pliant;
using namespace pliant::sim;
using namespace pliant::sim::inverse;
using namespace pliant::sim::inverse::testing;

namespace {

/// Cancels after so many samples.
class CancelAfterSamples final : public Progress {
public:
    explicit CancelAfterSamples(int samples) : left_(samples) {}
    void advance(std::string_view, double) override { --left_; }
    [[nodiscard]] bool cancelled() const override { return left_ <= 0; }

private:
    int left_;
};

void check_same(const Workspace& a, const Workspace& b) {
    REQUIRE(a.pieces.size() == b.pieces.size());
    for (std::size_t p = 0; p < a.pieces.size(); ++p) {
        REQUIRE(a.pieces[p].samples.size() == b.pieces[p].samples.size());
        for (std::size_t k = 0; k < a.pieces[p].samples.size(); ++k) {
            CHECK(a.pieces[p].samples[k].markers == b.pieces[p].samples[k].markers);
            CHECK(a.pieces[p].samples[k].tensions_N == b.pieces[p].samples[k].tensions_N);
        }
    }
}

}  // namespace

TEST_CASE("every sample is the equilibrium of its inputs, and the sheets include all ends of the ranges") {
    const Model model = made(bar(3));
    const InverseTask task = task_for(model, {{0.85, 1}, {0.85, 1}, {0.9, 1}});
    Progress silent;
    const auto workspace = find_workspace(model, tight, task, {.side = 3, .between = 4}, {}, {}, silent);
    REQUIRE(workspace);
    REQUIRE(workspace->pieces.size() == 7);  // three pairs of inputs, two ends of the third; and those in between
    int corners = 0;
    for (const WorkspacePiece& piece : workspace->pieces) {
        CHECK(piece.samples.size() == (piece.rows > 0 ? 9U : 4U));
        for (const WorkspaceSample& sample : piece.samples) {
            REQUIRE(sample.found);
            const bool corner =
                piece.rows > 0 && sample.values[0] != 0.925 && sample.values[1] != 0.925 && sample.values[2] != 0.95;
            corners += corner ? 1 : 0;
            if (!corner || sample.values[0] > 0.9) continue;
            CHECK(norm(sample.markers[0] - tip_under(model, task, sample.values)) < 2e-6);
        }
    }
    CHECK(corners == 24);
}

TEST_CASE("where nothing is found the first reason is told") {
    const WorkspaceSample none{{0.8}, false, {}, {}, {}}, one{{0.9}, true, {{1, 2, 3}}, {0.1}, {}};
    Workspace workspace{{{1, 1, {none}, "it is too far"}, {0, 0, {none}, "it is torn"}}, false};
    CHECK(why_nothing_is_found(workspace) == "no sample has an equilibrium: it is too far");
    workspace.pieces[1].samples.push_back(one);
    CHECK(why_nothing_is_found(workspace).empty());
}

TEST_CASE("samples stand in the order of the grid, wherever their solving begins") {
    const Model model = made(bar(2));
    const InverseTask task = task_for(model, {{0.85, 1}, {0.9, 1}});
    Progress silent;
    const auto workspace = find_workspace(model, tight, task, {.side = 3, .between = 0}, {}, {}, silent);
    REQUIRE(workspace);
    REQUIRE(workspace->pieces.size() == 1);
    std::vector<std::vector<double>> values;
    for (const WorkspaceSample& sample : workspace->pieces[0].samples) {
        values.push_back(sample.values);
        REQUIRE(sample.found);
        CHECK(norm(sample.markers[0] - tip_under(model, task, sample.values)) < 2e-6);
    }
    REQUIRE(values.size() == 9);
    CHECK(values.front() == std::vector<double>{0.85, 0.9});
    CHECK(values[2] == std::vector<double>{0.85, 1});
    CHECK(values[6] == std::vector<double>{1, 0.9});
    CHECK(values.back() == std::vector<double>{1, 1});
}

TEST_CASE("more than five actuators without samples in between are refused") {
    InverseTask task;
    task.inputs.resize(6);
    CHECK(check_samples(task, {.side = 9, .between = 1}));
    const Status refused = check_samples(task, {.side = 9, .between = 0});
    REQUIRE_FALSE(refused);
    CHECK(refused.error().cause == Cause::input);
    task.inputs.resize(5);
    CHECK(check_samples(task, {.side = 9, .between = 0}));
}

TEST_CASE("a resumed search gives the same bits") {
    const Model model = made(bar(2));
    const InverseTask task = task_for(model, {{0.85, 1}, {0.85, 1}});
    const WorkspaceOptions options{.side = 4, .between = 60};
    Progress silent;
    const auto whole = find_workspace(model, tight, task, options, {}, {}, silent);
    REQUIRE(whole);
    std::map<std::size_t, WorkspacePiece> kept;
    const auto known = [&](std::size_t k) { return kept.contains(k) ? std::optional(kept.at(k)) : std::nullopt; };
    const auto keep = [&](std::size_t k, const WorkspacePiece& piece) -> Status {
        kept[k] = piece;
        return {};
    };
    CancelAfterSamples impatient(20);
    const auto stopped = find_workspace(model, tight, task, options, known, keep, impatient);
    REQUIRE(stopped);
    CHECK(stopped->cancelled);
    CHECK(kept.size() == 1);
    const auto rest = find_workspace(model, tight, task, options, known, keep, silent);
    REQUIRE(rest);
    CHECK_FALSE(rest->cancelled);
    check_same(*whole, *rest);
    kept.at(0).samples[3].markers.clear();
    const auto mended = find_workspace(model, tight, task, options, known, keep, silent);
    REQUIRE(mended);
    check_same(*whole, *mended);
}

TEST_CASE("a piece is unchanged by serialisation, and damaged bytes are an error") {
    const WorkspacePiece piece{
        1, 2, {{{0.9, 1e-300}, true, {{1, 2, 3}}, {0.1}, {}}, {{0.8, 2}, false, {}, {}, {}}}, "it is too far"};
    const std::string bytes = piece_bytes(piece, "search 3");
    const auto read = piece_from_bytes(bytes, "search 3");
    REQUIRE(read);
    CHECK(read->rows == 1);
    CHECK(read->columns == 2);
    REQUIRE(read->samples.size() == 2);
    CHECK(read->samples[0].values == piece.samples[0].values);
    CHECK(read->samples[0].markers == piece.samples[0].markers);
    CHECK(read->samples[0].tensions_N == piece.samples[0].tensions_N);
    CHECK_FALSE(read->samples[1].found);
    CHECK(read->reason == "it is too far");
    CHECK_FALSE(piece_from_bytes(bytes, "search 4"));
    CHECK_FALSE(piece_from_bytes(bytes, "another 3"));
    for (std::size_t size = 0; size < bytes.size(); ++size)
        CHECK_FALSE(piece_from_bytes(bytes.substr(0, size), "search 3"));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ 4);
        CHECK_FALSE(piece_from_bytes(changed, "search 3"));
    }
    CHECK_FALSE(piece_from_bytes("robot", "search 3"));
}
