#include "loop/study/record.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "base/core/files.hpp"
#include "base/core/test_folder.hpp"

using namespace pliant;
using namespace pliant::study;
namespace fs = std::filesystem;

namespace {

/// Ten rows of one key and two results, in chunks of four.
Plan ten_rows() {
    Plan plan;
    plan.fingerprint = "00000000deadbeef";
    plan.command = {"simulate"};
    plan.keys = {{"k", "k", "", "", true}};
    plan.results = {{"a", "a"}, {"b", "b"}};
    for (int row = 0; row < 10; ++row) plan.rows.push_back({std::to_string(row)});
    plan.rows_per_chunk = 4;
    return plan;
}

RowRecord record(std::size_t row) {
    return {row, true, false, "", {0.1 * static_cast<double>(row), 1e-300}, 0.25, 0.125};
}

std::string chunk_text(const Plan& plan) {
    return records_header(plan, 1) + begun_line(4) + record_line(record(4)) + begun_line(6) + record_line(record(6));
}

Result<ChunkRecords> read_back(const Plan& plan, std::string_view text) {
    return parse_records(text, "00001.rows", records_header(plan, 1), 4, 8, 2);
}

}  // namespace

TEST_CASE("records are read back bit for bit") {
    const Plan plan = ten_rows();
    RowRecord failed{5, false, true, "no convergence: \"x\"\n at step 3", {NAN, -0.0}, 1, 2};
    failed.warning = "below a \"vacuum\"";
    const TaskRecord task{"node1 job 7_3", 3, 2.5, 2.25};
    const auto found = read_back(plan, chunk_text(plan) + record_line(failed) + record_line(task));
    REQUIRE(found);
    REQUIRE(found->rows.size() == 3);
    CHECK(found->rows[0] == record(4));
    CHECK(found->rows[1] == record(6));
    CHECK(std::isnan(found->rows[2].values[0]));
    CHECK(found->rows[2].reason == failed.reason);
    CHECK(found->rows[2].missing_path);
    CHECK(found->rows[2].warning == failed.warning);
    CHECK(found->tasks == std::vector{task});
    CHECK(found->begun.empty());
    CHECK(found->damaged == 0);
    CHECK(found->doubled == 0);
}

TEST_CASE("of a file that is cut off anywhere, the complete lines are read and nothing else") {
    const Plan plan = ten_rows();
    const std::string text = chunk_text(plan);
    for (std::size_t size = 0; size <= text.size(); ++size) {
        const std::string_view part = std::string_view(text).substr(0, size);
        const auto found = read_back(plan, part);
        REQUIRE(found);
        CHECK(found->damaged == 0);
        const std::size_t last = part.rfind('\n');
        CHECK(found->whole_bytes == (last == std::string_view::npos ? 0 : last + 1));
    }
}

TEST_CASE("any flipped bit of a record is noticed, and only that record is lost") {
    const Plan plan = ten_rows();
    const std::string text = chunk_text(plan);
    const std::size_t header = records_header(plan, 1).size();
    for (std::size_t at = header; at < text.size(); ++at) {
        for (const int bit : {0, 3, 7}) {
            std::string broken = text;
            broken[at] = static_cast<char>(broken[at] ^ (1 << bit));
            const auto found = read_back(plan, broken);
            REQUIRE(found);
            for (const RowRecord& row : found->rows) CHECK(row == record(row.row));
            CHECK(found->rows.size() >= 1);
        }
    }
}

TEST_CASE("records of another study are refused") {
    const Plan plan = ten_rows();
    Plan other = plan;
    other.fingerprint = "0000000000000001";
    const auto found = read_back(plan, records_header(other, 1) + record_line(record(4)));
    REQUIRE_FALSE(found);
    CHECK(found.error().message == "00001.rows: holds records of another study");
}

TEST_CASE("rows of other chunks and repeated records are not counted") {
    const Plan plan = ten_rows();
    const auto found = read_back(plan, chunk_text(plan) + record_line(record(9)) + record_line(record(4)));
    REQUIRE(found);
    CHECK(found->rows.size() == 2);
    CHECK(found->damaged == 1);
    CHECK(found->doubled == 1);
}

TEST_CASE("a row that was begun and did not end is reported, unless it was given up properly") {
    const Plan plan = ten_rows();
    const auto found =
        read_back(plan, chunk_text(plan) + begun_line(5) + begun_line(5) + begun_line(7) + given_up_line(7));
    REQUIRE(found);
    CHECK(found->begun == std::vector<std::size_t>{5, 5});
}

TEST_CASE("a chunk has one writer at a time; the next one continues after the last complete line") {
    const pliant::test::Folder folder("records");
    fs::create_directory(folder / "records");
    const Plan plan = ten_rows();
    {
        auto first = RecordFile::claim(plan, folder.path(), 1);
        REQUIRE((first && *first));
        REQUIRE((*first)->append(record_line(record(4))));
        const auto second = RecordFile::claim(plan, folder.path(), 1);
        REQUIRE(second);
        CHECK_FALSE(second->has_value());
        REQUIRE((*first)->append(record_line(record(5)).substr(0, 40)));  // as if killed during this write
    }
    auto next = RecordFile::claim(plan, folder.path(), 1);
    REQUIRE((next && *next));
    CHECK((*next)->records().rows.size() == 1);
    REQUIRE((*next)->append(record_line(record(6))));
    REQUIRE((*next)->sync());
    const auto found = read_records(plan, folder.path(), 1);
    REQUIRE(found);
    CHECK(found->rows == std::vector{record(4), record(6)});
    CHECK(found->damaged == 0);
}
