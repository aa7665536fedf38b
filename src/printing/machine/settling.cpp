#include "printing/machine/settling.hpp"

namespace pliant::machine {
namespace {

constexpr double tolerance_s = 2e-3;  // pauses are written in whole milliseconds

}  // namespace

void Settling::note(const Command& command, double at_s) {
    const Magnet& magnet = printer_->hooks.magnet;
    if (const auto on = switched(magnet.coil, command))
        magnet_ready_s_ = at_s + (*on ? magnet.engage_s : magnet.release_s);
    if (switched(printer_->wall.fork, command)) fork_ready_s_ = at_s + printer_->wall.fork_s;
}

Status Settling::check(const Position& from, const Position& to, double start_s) const {
    const bool carriage = from[Axis::carriage] != to[Axis::carriage];
    if (carriage && start_s < magnet_ready_s_ - tolerance_s)
        return failure("the carriage moves {:.3f} s before its magnet has settled", magnet_ready_s_ - start_s);
    const bool retriever = from[Axis::tower] != to[Axis::tower] || from[Axis::table] != to[Axis::table];
    if (retriever && start_s < fork_ready_s_ - tolerance_s)
        return failure("the retriever moves {:.3f} s before its fork has arrived", fork_ready_s_ - start_s);
    return {};
}

}  // namespace pliant::machine
