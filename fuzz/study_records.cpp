// Records of rows: arbitrary bytes, and arbitrary lines with correct checksums. What is read must be rows of the chunk,
// each at most once.
#include <cstdlib>
#include <set>

#include "base/core/digest.hpp"
#include "input.hpp"
#include "loop/study/record.hpp"

namespace {

using namespace pliant;

void read(std::string_view text, const std::string& header) {
    const auto records = study::parse_records(text, "fuzz.rows", header, 4, 8, 2);
    if (!records) return;
    std::set<std::size_t> met;
    for (const study::RowRecord& row : records->rows) {
        if (row.row < 4 || row.row >= 8 || row.values.size() != 2 || !met.insert(row.row).second) std::abort();
    }
    if (records->whole_bytes > text.size()) std::abort();
}

std::string with_checksums(std::string_view text, std::string header) {
    while (!text.empty()) {
        const std::string_view line = text.substr(0, text.find('\n'));
        text.remove_prefix(std::min(text.size(), line.size() + 1));
        Digest digest;
        digest.add(line.data(), line.size());
        header += digest.text() + " " + std::string(line) + "\n";
    }
    return header;
}

}  // namespace

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    study::Plan plan;
    plan.fingerprint = "0123456789abcdef";
    plan.rows_per_chunk = 4;
    const std::string header = study::records_header(plan, 1);
    const std::string_view text = as_text(data, size);
    read(text, header);
    read(header + std::string(text), header);
    read(with_checksums(text, header), header);
    return 0;
}
