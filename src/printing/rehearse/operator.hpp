// The operator at the virtual printer: does at once what the print requests, and resumes it.
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
    /// `refills`: the requests of the job, by layer, as in host::PrintJob.
    WillingOperator(twin::Twin& twin, std::vector<host::Refill> refills);
    /// Checks the print. If it is paused: fills vats and services the solution as its prompt requests, then resumes.
    /// While the door is open that is refused, and retried at the next call.
    void look(host::Control& control);

private:
    void do_as_asked(const std::string& prompt);

    twin::Twin& twin_;
    std::vector<host::Refill> refills_;
    std::size_t done_ = 0;  ///< number of refills done
    long last_event_ = 0;   ///< newest one seen
};

}  // namespace pliant::rehearse
