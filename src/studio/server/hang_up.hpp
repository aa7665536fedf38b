// Ends all waiting on the sockets of a server.
#pragma once

namespace pliant::studio {

/// Of this process' TCP sockets with this local port: no more is read from them, and what listens stops listening.
/// Threads that wait there go on at once; what was written is still sent. Precondition: port > 0.
void hang_up(int port);

}  // namespace pliant::studio
