#include "printing/machine/board_report.hpp"

#include "input.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto board = pliant::machine::parse_board_report(as_text(data, size));
    (void)pliant::machine::check_board(board, pliant::machine::Printer{});
    return 0;
}
