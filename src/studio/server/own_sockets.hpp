// The sockets of this process.
#pragma once

#include <vector>

namespace pliant::studio {

/// Files of this process' TCP sockets with this local port: what listens there, and the connections. Precondition: port
/// > 0.
[[nodiscard]] std::vector<int> sockets_at(int port);

}  // namespace pliant::studio
