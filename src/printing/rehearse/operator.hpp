// Who stands at the virtual printer while it prints: does at once what the print asks of a person, and resumes it.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "printing/host/control.hpp"
#include "printing/twin/twin.hpp"

namespace pliant::rehearse {

/// The twin must outlive it.
class WillingOperator {
public:
    /// `refills`: what the job will ask for, by layer, as host::PrintJob has it.
    WillingOperator(twin::Twin& twin, std::vector<host::Refill> refills);
    /// Looks at the print. If it is paused: fills vats and looks after the solution as its prompt asks, then resumes.
    /// While the door is open that is refused, and tried again at the next look.
    void look(host::Control& control);

private:
    void do_as_asked(const std::string& prompt);

    twin::Twin& twin_;
    std::vector<host::Refill> refills_;
    std::size_t done_ = 0;  ///< of them
};

}  // namespace pliant::rehearse
